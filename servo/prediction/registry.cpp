#include "servo/prediction/registry.hpp"

namespace heartservo::servo {

const Registry<MotionPredictor, const PredictorOptions&>& predictors() {
  static const Registry<MotionPredictor, const PredictorOptions&> registry(
      "predictor",
      {{"hold", "the last measured position stays", make_hold},
       {"constant_velocity", "Kalman filter: the velocity stays, but for white acceleration", make_constant_velocity},
       {"constant_acceleration", "Kalman filter: the acceleration stays, but for white jerk",
        make_constant_acceleration},
       {"autoregressive", "recursive least squares on the last samples, for each horizon by itself",
        make_autoregressive},
       {"analogue", "what came after the moments that were most like the last third of a second", make_analogue},
       {"harmonic", "Fourier series in the phases of heart and breath, which are tracked; only diastole stretches",
        make_harmonic},
       {"harmonic_ecg", "harmonic, and R peaks of an ECG set the heart's phase", make_harmonic_ecg},
       {"mixture", "all of them, weighted by how well they foresaw lately", make_mixture}});
  return registry;
}

}  // namespace heartservo::servo
