#include "servo/prediction/horizon_errors.hpp"

#include <algorithm>

namespace heartservo::servo {

HorizonErrors::HorizonErrors(double horizon_s, int predictors, double slow_s, double fast_s)
    : horizon_s_(horizon_s), slow_s_(slow_s), fast_s_(fast_s), pending_(kMost) {
  for (auto& p : pending_) p.positions.setZero(predictors, 3);
  products_.setZero(predictors, predictors);
  fast_.setZero(predictors);
  age_.setZero(predictors);
  largest_.setZero(predictors);
  weights_.setZero(predictors);
}

void HorizonErrors::forget() {
  first_ = end_ = 0;
  seen_ = false;
  products_.setZero();
  fast_.setZero();
  age_.setZero();
  largest_.setZero();
  weights_.setZero();
}

void HorizonErrors::observe(double time_s, const Axes& position) {
  while (first_ != end_) {
    const Pending& p = pending_[first_ % kMost];
    if (p.time_s > time_s + 1e-9) break;
    ++first_;
    // after a gap nothing is known of the time in between
    if (!seen_ || p.time_s < last_s_ || (time_s - last_s_ > kGap_s && p.time_s < time_s - 1e-6)) continue;
    const double share = (p.time_s - last_s_) / (time_s - last_s_);
    const Axes truth = last_ + share * (position - last_);
    judge(p.positions.rowwise() - truth, p.dt);
  }
  seen_ = true;
  last_s_ = time_s;
  last_ = position;
}

HorizonErrors::Positions& HorizonErrors::predictions(double time_s) {
  if (end_ - first_ == kMost) ++first_;
  Pending& p = pending_[end_++ % kMost];
  p.dt = std::clamp(time_s - added_s_, 0.0, 0.2);
  added_s_ = time_s;
  p.time_s = time_s + horizon_s_;
  return p.positions;
}

void HorizonErrors::judge(const Positions& errors, double dt) {
  const int n = static_cast<int>(age_.size());
  for (int i = 0; i < n; ++i) {
    if (!errors.row(i).allFinite()) {
      age_[i] = 0;
      continue;
    }
    age_[i] += dt;
    largest_[i] = std::max(errors.row(i).norm(), largest_[i] * (1 - dt / kLargest_s));
    fast_[i] += std::min(1.0, dt / std::min(fast_s_, age_[i])) * (errors.row(i).squaredNorm() - fast_[i]);
    for (int j = 0; j <= i; ++j) {
      if (!(age_[j] > 0)) continue;
      const double gain = std::min(1.0, dt / std::min({slow_s_, age_[i], age_[j]}));
      products_(i, j) += gain * (errors.row(i).dot(errors.row(j)) - products_(i, j));
      products_(j, i) = products_(i, j);
    }
  }
}

void HorizonErrors::weigh() {
  weights_.setZero();
  std::array<int, kMostPredictors> in{};
  int n = 0;
  for (int i = 0; i < age_.size(); ++i)
    if (age_[i] > kLeast_s) in[static_cast<std::size_t>(n++)] = i;
  while (n > 0) {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostPredictors, kMostPredictors> c(n, n);
    const auto at = [&](int a) { return in[static_cast<std::size_t>(a)]; };
    // one that has just failed counts as bad as it was just now
    const auto worse = [&](int i) { return std::sqrt(std::max(1.0, fast_[i] / std::max(products_(i, i), 1e-30))); };
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b) c(a, b) = products_(at(a), at(b)) * worse(at(a)) * worse(at(b));
    c.diagonal().array() += 0.01 * c.diagonal().minCoeff() + 1e-16;
    const Weights one = Weights::Ones(n);
    const Weights w = c.llt().solve(one);
    int least = 0;
    w.minCoeff(&least);
    if (n == 1 || w[least] >= 0) {
      if (w.allFinite() && w.sum() > 0)
        for (int a = 0; a < n; ++a) weights_[at(a)] = w[a] / w.sum();
      return;
    }
    for (int a = least; a + 1 < n; ++a) in[static_cast<std::size_t>(a)] = at(a + 1);
    --n;
  }
}

}  // namespace heartservo::servo
