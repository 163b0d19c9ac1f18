// Kalman filter of position and velocity, each axis for itself, driven by white acceleration of spectral density q
// (Bar-Shalom, Li, Kirubarajan: Estimation with Applications to Tracking and Navigation, section 6.2.2).
#include <Eigen/LU>
#include <cmath>

#include "servo/prediction/registry.hpp"

namespace heartservo::servo {

namespace {

constexpr double kUnknownSpeed = 0.3;  // m/s, standard deviation before anything is known

struct Axis {
  Eigen::Vector2d x = Eigen::Vector2d::Zero();  // position, velocity
  Eigen::Matrix2d P = Eigen::Matrix2d::Zero();

  void advance(double dt, double q) {
    Eigen::Matrix2d F;
    F << 1, dt, 0, 1;
    Eigen::Matrix2d Q;
    Q << dt * dt * dt / 3, dt * dt / 2, dt * dt / 2, dt;
    x = F * x;
    P = F * P * F.transpose() + q * Q;
  }

  void update(double measured, double variance) {
    const Eigen::Vector2d gain = P.col(0) / (P(0, 0) + variance);
    x += gain * (measured - x[0]);
    P -= gain * P.row(0).eval();
    P = (0.5 * (P + P.transpose())).eval();
  }
};

class ConstantVelocity final : public MotionPredictor {
 public:
  explicit ConstantVelocity(const PredictorOptions& options) : options_(options) {}

  void observe(const MotionSample& sample) override {
    if (!sample.position.allFinite() || !std::isfinite(sample.time_s)) return;
    if (samples_ > 0 && !(sample.time_s > time_s_)) return;
    const double floor = options_.smallest_sigma_m * options_.smallest_sigma_m;
    for (int i = 0; i < 3; ++i) {
      Axis& axis = axes_[static_cast<std::size_t>(i)];
      double variance = sample.covariance(i, i);
      variance = std::isfinite(variance) ? std::max(variance, floor) : 1;
      if (samples_ == 0) {
        axis.x << sample.position[i], 0;
        axis.P << variance, 0, 0, kUnknownSpeed * kUnknownSpeed;
      } else {
        axis.advance(sample.time_s - time_s_, options_.acceleration_density);
        axis.update(sample.position[i], variance);
      }
    }
    time_s_ = sample.time_s;
    ++samples_;
  }

  Prediction predict(double time_s) const override {
    Prediction p;
    p.valid = samples_ >= 2;
    p.time_s = time_s;
    for (int i = 0; i < 3; ++i) {
      Axis axis = axes_[static_cast<std::size_t>(i)];
      axis.advance(std::max(0.0, time_s - time_s_), options_.acceleration_density);
      p.position[i] = axis.x[0];
      p.velocity[i] = axis.x[1];
      p.covariance(i, i) = axis.P(0, 0);
    }
    return p;
  }

 private:
  PredictorOptions options_;
  std::array<Axis, 3> axes_;
  double time_s_ = 0;
  long samples_ = 0;
};

}  // namespace

std::unique_ptr<MotionPredictor> make_constant_velocity(const PredictorOptions& options) {
  return std::make_unique<ConstantVelocity>(options);
}

}  // namespace heartservo::servo
