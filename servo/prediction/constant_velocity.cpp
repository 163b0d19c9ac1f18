#include "servo/prediction/polynomial_kalman.hpp"

namespace heartservo::servo {

std::unique_ptr<MotionPredictor> make_constant_velocity(const PredictorOptions& options) {
  return std::make_unique<PolynomialKalman<2>>(options.acceleration_density, options.smallest_sigma_m,
                                               Eigen::Vector2d(0.3, 0));
}

}  // namespace heartservo::servo
