#pragma once
#include "servo/prediction/motion_predictor.hpp"
#include "tracking/settings/fields.hpp"
#include "tracking/settings/registry.hpp"

namespace heartservo::servo {

struct PredictorOptions {
  double acceleration_density = 10;  ///< m^2/s^3
  double jerk_density = 100;         ///< m^2/s^5
  double smallest_sigma_m = 1e-5;    ///< m
  int harmonics = 12;                ///< of the heartbeat
  double memory_s = 40;              ///< of the harmonic model's coefficients

  void fields(FieldVisitor& v) {
    v.field({"acceleration_density", "m^2/s^3",
             "constant_velocity: spectral density of the acceleration taken as white", 1e-6, 1e6},
            acceleration_density);
    v.field(
        {"jerk_density", "m^2/s^5", "constant_acceleration: spectral density of the jerk taken as white", 1e-6, 1e9},
        jerk_density);
    v.field({"harmonics", "", "harmonic predictors: harmonics of the heartbeat, as far as sampling reaches", 1, 16},
            harmonics);
    v.field({"memory_s", "s", "harmonic predictors: time constant of forgetting the beat's shape", 5, 1000}, memory_s);
    v.field({"smallest_sigma_m", "m", "a measured position is never believed better than this", 0, 0.1},
            smallest_sigma_m);
  }
};

/// Predictors by name.
const Registry<MotionPredictor, const PredictorOptions&>& predictors();

std::unique_ptr<MotionPredictor> make_hold(const PredictorOptions& options);
std::unique_ptr<MotionPredictor> make_constant_velocity(const PredictorOptions& options);
std::unique_ptr<MotionPredictor> make_constant_acceleration(const PredictorOptions& options);
std::unique_ptr<MotionPredictor> make_autoregressive(const PredictorOptions& options);
std::unique_ptr<MotionPredictor> make_analogue(const PredictorOptions& options);
std::unique_ptr<MotionPredictor> make_harmonic(const PredictorOptions& options);
std::unique_ptr<MotionPredictor> make_harmonic_ecg(const PredictorOptions& options);
std::unique_ptr<MotionPredictor> make_mixture(const PredictorOptions& options);

}  // namespace heartservo::servo
