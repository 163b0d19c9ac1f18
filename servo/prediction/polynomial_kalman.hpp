#pragma once
// Kalman filter of a position and its first derivatives, each axis for itself, the highest derivative driven by white
// noise of spectral density q (Bar-Shalom, Li, Kirubarajan: Estimation with Applications to Tracking and Navigation,
// section 6.2). Two states: constant velocity; three: constant acceleration.
#include <Eigen/Core>
#include <array>
#include <cmath>

#include "servo/prediction/registry.hpp"

namespace heartservo::servo {

template <int kStates>
class PolynomialKalman final : public MotionPredictor {
 public:
  /// `density`: of the noise on the derivative of order kStates; `first_sigmas`: of the derivatives before anything is
  /// known (m/s, m/s^2).
  PolynomialKalman(double density, double smallest_sigma_m, const Eigen::Vector2d& first_sigmas)
      : density_(density), smallest_variance_(smallest_sigma_m * smallest_sigma_m), first_sigmas_(first_sigmas) {}

  void observe(const MotionSample& sample) override {
    if (!sample.position.allFinite() || !std::isfinite(sample.time_s)) return;
    if (samples_ > 0 && !(sample.time_s > time_s_)) return;
    for (int i = 0; i < 3; ++i) {
      Axis& axis = axes_[static_cast<std::size_t>(i)];
      double variance = sample.covariance(i, i);
      variance = std::isfinite(variance) ? std::max(variance, smallest_variance_) : 1;
      if (samples_ == 0) {
        axis.x.setZero();
        axis.x[0] = sample.position[i];
        axis.P.setZero();
        axis.P(0, 0) = variance;
        for (int k = 1; k < kStates; ++k) axis.P(k, k) = first_sigmas_[k - 1] * first_sigmas_[k - 1];
      } else {
        advance(axis, sample.time_s - time_s_);
        update(axis, sample.position[i], variance);
      }
    }
    time_s_ = sample.time_s;
    ++samples_;
  }

  Prediction predict(double time_s) const override {
    Prediction p;
    p.valid = samples_ >= kStates;
    p.time_s = time_s;
    for (int i = 0; i < 3; ++i) {
      Axis axis = axes_[static_cast<std::size_t>(i)];
      advance(axis, std::max(0.0, time_s - time_s_));
      p.position[i] = axis.x[0];
      p.velocity[i] = axis.x[1];
      p.covariance(i, i) = axis.P(0, 0);
    }
    return p;
  }

 private:
  using Vector = Eigen::Matrix<double, kStates, 1>;
  using Matrix = Eigen::Matrix<double, kStates, kStates>;
  struct Axis {
    Vector x = Vector::Zero();
    Matrix P = Matrix::Zero();
  };

  void advance(Axis& axis, double dt) const {
    Matrix F = Matrix::Zero(), Q = Matrix::Zero();
    for (int r = 0; r < kStates; ++r)
      for (int c = 0; c < kStates; ++c) {
        if (c >= r) F(r, c) = std::pow(dt, c - r) / factorial(c - r);
        const int a = kStates - 1 - r, b = kStates - 1 - c;  // integral of s^a/a! s^b/b! over the step
        Q(r, c) = std::pow(dt, a + b + 1) / (factorial(a) * factorial(b) * (a + b + 1));
      }
    axis.x = (F * axis.x).eval();
    axis.P = (F * axis.P * F.transpose() + density_ * Q).eval();
  }

  static void update(Axis& axis, double measured, double variance) {
    const Vector gain = axis.P.col(0) / (axis.P(0, 0) + variance);
    axis.x += gain * (measured - axis.x[0]);
    axis.P -= (gain * axis.P.row(0)).eval();
    axis.P = (0.5 * (axis.P + axis.P.transpose())).eval();
  }

  static double factorial(int n) { return n <= 1 ? 1 : n * factorial(n - 1); }

  double density_, smallest_variance_;
  Eigen::Vector2d first_sigmas_;
  std::array<Axis, 3> axes_;
  double time_s_ = 0;
  long samples_ = 0;
};

}  // namespace heartservo::servo
