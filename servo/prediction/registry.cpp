#include "servo/prediction/registry.hpp"

namespace heartservo::servo {

const Registry<MotionPredictor, const PredictorOptions&>& predictors() {
  static const Registry<MotionPredictor, const PredictorOptions&> registry(
      "predictor",
      {{"hold", "the last measured position stays", make_hold},
       {"constant_velocity", "Kalman filter: the velocity stays, but for white acceleration", make_constant_velocity},
       {"constant_acceleration", "Kalman filter: the acceleration stays, but for white jerk",
        make_constant_acceleration}});
  return registry;
}

}  // namespace heartservo::servo
