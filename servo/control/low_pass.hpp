#pragma once
#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace heartservo::servo {

/// First-order low-pass of a command. It delays by 1 / (2 pi cutoff); 0 leaves everything through.
class LowPass {
 public:
  explicit LowPass(double cutoff_hz) : cutoff_hz_(cutoff_hz) {}

  /// What is not finite passes, for the guard to see, and is forgotten.
  Eigen::Vector3d next(const Eigen::Vector3d& v, double period_s) {
    if (!v.allFinite() || cutoff_hz_ <= 0) return v;
    state_ += (1 - std::exp(-2 * std::numbers::pi * cutoff_hz_ * period_s)) * (v - state_);
    return state_;
  }

 private:
  double cutoff_hz_;
  Eigen::Vector3d state_ = Eigen::Vector3d::Zero();
};

}  // namespace heartservo::servo
