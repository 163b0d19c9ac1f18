#include "servo/prediction/registry.hpp"

namespace heartservo::servo {

const Registry<MotionPredictor, const PredictorOptions&>& predictors() {
  static const Registry<MotionPredictor, const PredictorOptions&> registry(
      "predictor",
      {{"hold", "the last measured position stays", make_hold},
       {"constant_velocity", "Kalman filter: the velocity stays, but for white acceleration", make_constant_velocity}});
  return registry;
}

}  // namespace heartservo::servo
