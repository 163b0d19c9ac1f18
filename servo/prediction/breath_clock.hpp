#pragma once
// The phase of breathing: a ventilator's, hence a steady rate that drifts. Kalman filter of phase (cycles) and rate
// (Hz), measured through the motion's slope by the phase.
#include <Eigen/Core>
#include <algorithm>

namespace heartservo::servo {

class BreathClock {
 public:
  void start(double phase, double rate_hz, double rate_sigma_hz, double phase_sigma) {
    x_ = {phase, rate_hz};
    P_ = Eigen::Vector2d(phase_sigma * phase_sigma, rate_sigma_hz * rate_sigma_hz).asDiagonal();
  }

  void advance(double dt) {
    Eigen::Matrix2d F;
    F << 1, dt, 0, 1;
    x_ = (F * x_).eval();
    P_ = (F * P_ * F.transpose()).eval();
    P_(0, 0) += kPhaseWalk * kPhaseWalk * dt;
    P_(1, 1) += kRateWalk * kRateWalk * dt;
  }

  double foresee(double dt, double& variance) const {
    BreathClock then = *this;
    then.advance(dt);
    variance = then.P_(0, 0);
    return then.x_[0];
  }

  /// A scalar measurement whose value is too large by `innovation`.
  void update(double innovation, double slope, double variance) {
    const Eigen::Vector2d Ph = P_.col(0) * slope;
    const Eigen::Vector2d k = Ph / (slope * Ph[0] + variance);
    x_ += k * innovation;
    P_ -= (k * Ph.transpose()).eval();
    P_ = (0.5 * (P_ + P_.transpose())).eval();
    x_[1] = std::clamp(x_[1], kSlowest_hz, kFastest_hz);
  }

  double phase() const { return x_[0]; }
  double phase_variance() const { return P_(0, 0); }
  double rate_hz() const { return x_[1]; }

  static constexpr double kSlowest_hz = 0.1, kFastest_hz = 0.6;  ///< 6 to 36 breaths a minute

 private:
  // A breath's length varies by about half a percent: a random walk of the phase, and a drift of the rate.
  static constexpr double kPhaseWalk = 2e-3, kRateWalk = 5e-4;
  Eigen::Vector2d x_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d P_ = Eigen::Matrix2d::Zero();
};

}  // namespace heartservo::servo
