#include "servo/prediction/rate_search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace heartservo::servo {

RateSearch::RateSearch() {
  p_.setZero();
  curve_.setZero();
}

void RateSearch::begin(const UniformTrack& track) {
  step_s_ = track.step_s();
  size_ = std::min({track.size(), kMost, static_cast<int>(kLongest_s / step_s_)});
  begin_s_ = track.end_s() - step_s_ * (size_ - 1);
  for (int i = 0; i < size_; ++i) p_.row(i) = track.at(size_ - 1 - i);
  reach_ = std::max(1, static_cast<int>(std::lround(0.14 / step_s_)));
  for (int i = 0; i < size_; ++i) {
    const int at = std::clamp(i, reach_, size_ - 1 - reach_);
    curve_.row(i) = p_.row(at - reach_) - 2 * p_.row(at) + p_.row(at + reach_);
  }
  shortest_ = std::max(2, static_cast<int>(1 / (kFastestBeat_hz * step_s_)));
  // a lag needs as much again to be compared over
  longest_ = std::min({static_cast<int>(1 / (kSlowestBeat_hz * step_s_)), kLags - 1, (size_ - 2 * reach_) * 9 / 20});
  lag_ = shortest_;
  found_ = false;
  first_mark_ = end_mark_ = 0;
  stage_ = longest_ > shortest_ + 2 ? Stage::LAGS : Stage::DONE;
}

void RateSearch::begin(const UniformTrack& track, std::span<const double> r_peaks_s) {
  begin(track);
  stage_ = Stage::DONE;
  for (const double peak : r_peaks_s)
    if (peak >= begin_s_ && end_mark_ < kMarks)
      marks_[static_cast<std::size_t>(end_mark_++)] = (peak - begin_s_) / step_s_;
  if (end_mark_ < 4) return;
  period_ = (marks_[static_cast<std::size_t>(end_mark_ - 1)] - marks_[0]) / (end_mark_ - 1);
  begin_breath();
}

bool RateSearch::step() {
  switch (stage_) {
    case Stage::LAGS:
      lag_slice();
      break;
    case Stage::MARKS:
      mark_slice();
      break;
    case Stage::BREATH:
      breath_slice();
      break;
    case Stage::DONE:
      break;
  }
  return stage_ == Stage::DONE;
}

double RateSearch::unlike(int at, int other, int length) const {
  return (curve_.middleRows(at, length) - curve_.middleRows(other, length)).squaredNorm() / length;
}

void RateSearch::lag_slice() {
  const int begin = reach_, end = size_ - reach_;
  for (int n = 0; n < 8 && lag_ <= longest_; ++n, ++lag_) {
    const int length = end - begin - lag_;
    // twice the power of both stretches that are compared: 1 where they have nothing in common
    const double power =
        (curve_.middleRows(begin, length).squaredNorm() + curve_.middleRows(begin + lag_, length).squaredNorm()) /
        length;
    difference_[static_cast<std::size_t>(lag_)] = unlike(begin, begin + lag_, length) / std::max(power, 1e-30);
  }
  if (lag_ > longest_) choose_period();
}

void RateSearch::choose_period() {
  const auto d = [&](int lag) { return difference_[static_cast<std::size_t>(lag)]; };
  double best = 0.6;  // worse than this is no repetition
  int chosen = 0;
  for (int lag = shortest_ + 1; lag < longest_; ++lag) {
    if (!(d(lag) <= d(lag - 1) && d(lag) <= d(lag + 1))) continue;
    // beats differ in length: what repeats after one beat repeats less well after two
    if (chosen == 0 ? d(lag) < best : d(lag) < 0.9 * best - 0.02) {
      best = d(lag);
      chosen = lag;
    }
  }
  if (chosen == 0) {
    stage_ = Stage::DONE;
    return;
  }
  const double bend = d(chosen - 1) - 2 * d(chosen) + d(chosen + 1);
  period_ = chosen + (bend > 0 ? 0.5 * (d(chosen - 1) - d(chosen + 1)) / bend : 0);
  unlikeness_ = best;
  stage_ = Stage::MARKS;
  first_mark_ = kMarks / 2;
  end_mark_ = first_mark_ + 1;
  marks_[static_cast<std::size_t>(first_mark_)] = std::floor(0.5 * (size_ - period_));
  forward_ = true;
}

// Where around `expected` the beat that begins at `from` is found again; NaN at the end of the motion.
double RateSearch::match(double from, double expected) const {
  const int length = static_cast<int>(period_), at = static_cast<int>(std::lround(from));
  const int reach = std::max(2, static_cast<int>(0.18 * period_)), middle = static_cast<int>(std::lround(expected));
  const int low = std::max(0, middle - reach), high = std::min(size_ - length, middle + reach), count = high - low + 1;
  if (middle < low || middle > high) return NAN;
  int best = 0;
  std::array<double, 2 * kLags> cost;
  for (int i = 0; i < count; ++i) {
    cost[static_cast<std::size_t>(i)] = unlike(at, low + i, length);
    if (cost[static_cast<std::size_t>(i)] < cost[static_cast<std::size_t>(best)]) best = i;
  }
  double fine = 0;
  if (best > 0 && best + 1 < count) {
    const double *c = &cost[static_cast<std::size_t>(best)], bend = c[-1] - 2 * c[0] + c[1];
    if (bend > 0) fine = std::clamp(0.5 * (c[-1] - c[1]) / bend, -0.5, 0.5);
  }
  // the comparison started at a whole step
  return low + best + fine + (from - at);
}

void RateSearch::mark_slice() {
  auto mark = [&](int i) -> double& { return marks_[static_cast<std::size_t>(i)]; };
  if (forward_) {
    const double next = end_mark_ < kMarks ? match(mark(end_mark_ - 1), mark(end_mark_ - 1) + period_) : NAN;
    if (std::isfinite(next) && next > mark(end_mark_ - 1) + 0.5 * period_)
      mark(end_mark_++) = next;
    else
      forward_ = false;
    return;
  }
  const double before = first_mark_ > 0 ? match(mark(first_mark_), mark(first_mark_) - period_) : NAN;
  if (std::isfinite(before) && before < mark(first_mark_) - 0.5 * period_) {
    mark(--first_mark_) = before;
    return;
  }
  if (end_mark_ - first_mark_ >= 2) period_ = (mark(end_mark_ - 1) - mark(first_mark_)) / (end_mark_ - 1 - first_mark_);
  begin_breath();
}

void RateSearch::begin_breath() {
  stage_ = Stage::BREATH;
  breath_ = 0;
  best_left_ = INFINITY;
}

double RateSearch::beat_phase(double time_s) const {
  const double at = (time_s - begin_s_) / step_s_;
  const auto mark = [&](int i) { return marks_[static_cast<std::size_t>(i)]; };
  if (at < mark(first_mark_)) return first_mark_ + (at - mark(first_mark_)) / period_;
  int i = first_mark_;
  while (i + 1 < end_mark_ && at >= mark(i + 1)) ++i;
  const double length = i + 1 < end_mark_ ? mark(i + 1) - mark(i) : period_;
  return i + (at - mark(i)) / length;
}

void RateSearch::breath_slice() {
  constexpr int kParameters = 13;
  using Vector = Eigen::Matrix<double, kParameters, 1>;
  const double rate = kSlowestBreath_hz *
                      std::pow(kFastestBreath_hz / kSlowestBreath_hz, static_cast<double>(breath_) / (kBreaths - 1));
  Eigen::Matrix<double, kParameters, kParameters> N = Eigen::Matrix<double, kParameters, kParameters>::Zero();
  Eigen::Matrix<double, kParameters, 3> b = Eigen::Matrix<double, kParameters, 3>::Zero();
  double power = 0;
  const int stride = std::max(1, static_cast<int>(0.05 / step_s_));
  const Eigen::RowVector3d middle = p_.row(size_ / 2);
  for (int i = 0; i < size_; i += stride) {
    const double t = begin_s_ + i * step_s_;
    const std::complex<double> u = std::polar(1.0, 2 * std::numbers::pi * beat_phase(t)),
                               v = std::polar(1.0, 2 * std::numbers::pi * rate * i * step_s_);
    Vector h;
    h[0] = 1;
    std::complex<double> z = 1;
    for (int k = 0; k < 2; ++k) {
      z *= v;
      h[1 + 2 * k] = z.real();
      h[2 + 2 * k] = z.imag();
    }
    z = 1;
    for (int k = 0; k < 4; ++k) {
      z *= u;
      h[5 + 2 * k] = z.real();
      h[6 + 2 * k] = z.imag();
    }
    N.selfadjointView<Eigen::Lower>().rankUpdate(h);
    b.noalias() += h * (p_.row(i) - middle);
    power += (p_.row(i) - middle).squaredNorm();
  }
  // a little of the identity: over less than a breath, slow rates fit anything with huge coefficients
  N.diagonal().array() += 1e-3 * N(0, 0);
  const Eigen::LLT<Eigen::Matrix<double, kParameters, kParameters>, Eigen::Lower> cholesky(N);
  const double left = power - (b.array() * cholesky.solve(b).array()).sum();
  if (left < best_left_) {
    best_left_ = left;
    breath_hz_ = rate;
  }
  if (++breath_ < kBreaths) return;
  stage_ = Stage::DONE;
  found_ = true;
}

}  // namespace heartservo::servo
