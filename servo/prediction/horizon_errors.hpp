#pragma once
// How well predictions came true, at several horizons: each is kept until a sample reaches the time it was for, and the
// squared error then enters a fast and a slow running mean. What lies between two samples is taken from the straight
// line between them. Nothing is allocated after construction.
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

namespace heartservo::servo {

class HorizonErrors {
 public:
  using Axes = Eigen::Matrix<double, 1, 3>;

  HorizonErrors(double horizon_s, std::size_t predictors, double fast_s = 0.7, double slow_s = 6)
      : horizon_s_(horizon_s), fast_s_(fast_s), slow_s_(slow_s), pending_(kMost), means_(predictors) {
    for (auto& p : pending_) p.positions.resize(predictors);
  }

  double horizon_s() const { return horizon_s_; }

  void forget() {
    first_ = end_ = 0;
    seen_ = false;
    for (auto& m : means_) m = {};
  }

  /// Before the predictions made at `time_s` are added: what was foreseen for the time since the last sample.
  void observe(double time_s, const Axes& position) {
    while (first_ != end_) {
      const Pending& p = pending_[first_ % kMost];
      if (p.time_s > time_s + 1e-9) break;
      ++first_;
      // after a gap nothing is known of the time in between
      if (!seen_ || p.time_s < last_s_ || (time_s - last_s_ > kGap_s && p.time_s < time_s - 1e-6))
        continue;
      const double share = (p.time_s - last_s_) / (time_s - last_s_);
      const Axes truth = last_ + share * (position - last_);
      for (std::size_t i = 0; i < means_.size(); ++i) add(means_[i], (p.positions[i] - truth).squaredNorm(), p.dt);
    }
    seen_ = true;
    last_s_ = time_s;
    last_ = position;
  }

  /// Room for the predictions made at `time_s`, for the horizon later: position [i] of predictor i, NaN for none.
  std::vector<Axes>& predictions(double time_s) {
    if (end_ - first_ == kMost) ++first_;
    Pending& p = pending_[end_++ % kMost];
    p.dt = std::min(0.2, time_s - added_s_);
    added_s_ = time_s;
    p.time_s = time_s + horizon_s_;
    return p.positions;
  }

  /// Mean squared distances, m^2; infinite before anything came true.
  double fast(std::size_t i) const { return means_[i].weight > 0.1 ? means_[i].fast : INFINITY; }
  double slow(std::size_t i) const { return means_[i].weight > 0.1 ? means_[i].slow : INFINITY; }
  /// Seconds of experience.
  double experience_s(std::size_t i) const { return means_[i].weight; }

 private:
  static constexpr std::size_t kMost = 256;
  static constexpr double kGap_s = 0.1;
  struct Pending {
    double time_s = 0, dt = 0;
    std::vector<Axes> positions;
  };
  struct Mean {
    double fast = 0, slow = 0, weight = 0;
  };

  void add(Mean& m, double squared, double dt) const {
    if (!std::isfinite(squared)) {
      m = {};
      return;
    }
    m.weight += dt;
    m.fast += std::min(1.0, dt / std::min(fast_s_, m.weight)) * (squared - m.fast);
    m.slow += std::min(1.0, dt / std::min(slow_s_, m.weight)) * (squared - m.slow);
  }

  double horizon_s_, fast_s_, slow_s_;
  std::vector<Pending> pending_;
  std::vector<Mean> means_;
  std::size_t first_ = 0, end_ = 0;
  double last_s_ = 0, added_s_ = 0;
  Axes last_ = Axes::Zero();
  bool seen_ = false;
};

}  // namespace heartservo::servo
