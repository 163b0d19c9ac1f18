#include "servo/prediction/polynomial_kalman.hpp"

namespace heartservo::servo {

std::unique_ptr<MotionPredictor> make_constant_acceleration(const PredictorOptions& options) {
  return std::make_unique<PolynomialKalman<3>>(options.jerk_density, options.smallest_sigma_m, Eigen::Vector2d(0.3, 5));
}

}  // namespace heartservo::servo
