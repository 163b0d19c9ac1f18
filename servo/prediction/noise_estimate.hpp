#pragma once
// The measurement noise of a motion, per axis, from the samples alone: third differences of equally spaced samples hold
// hardly any motion when sampling is fast, and 20 times the noise's variance. Of slow samples they hold motion too, and
// the estimate is too large. A running median keeps it from single jumps.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace heartservo::servo {

class NoiseEstimate {
 public:
  using Axes = Eigen::Matrix<double, 1, 3>;

  void add(double time_s, const Axes& position) {
    const double dt = time_s - time_s_;
    if (count_ > 0 && std::abs(dt - dt_) > 0.1 * dt_) count_ = 1;
    p_[3] = p_[2];
    p_[2] = p_[1];
    p_[1] = p_[0];
    p_[0] = position;
    time_s_ = time_s;
    dt_ = dt;
    if (++count_ < 4) return;
    const Axes third = p_[0] - 3 * p_[1] + 3 * p_[2] - p_[3];
    // the median of |third| is 0.6745 sigma: a step up or down, smaller with time
    const double gain = std::max(0.01, 1.0 / ++steps_);
    for (int i = 0; i < 3; ++i) {
      const double size = std::abs(third[i]);
      if (steps_ == 1)
        median_[i] = size;
      else
        median_[i] *= std::exp(size > median_[i] ? 2 * gain : -2 * gain);
      median_[i] = std::max(median_[i], 1e-9);
    }
  }

  bool known() const { return steps_ >= 30; }
  Axes variance() const { return (median_.array() / 0.6745).square() / 20; }

 private:
  std::array<Axes, 4> p_{Axes::Zero(), Axes::Zero(), Axes::Zero(), Axes::Zero()};
  Axes median_ = Axes::Constant(1e-4);
  double time_s_ = 0, dt_ = 0;
  long count_ = 0, steps_ = 0;
};

}  // namespace heartservo::servo
