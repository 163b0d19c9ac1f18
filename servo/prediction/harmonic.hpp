#pragma once
// The harmonic model as a predictor.
#include "servo/prediction/harmonic_tracker.hpp"

namespace heartservo::servo {

class Harmonic final : public MotionPredictor {
 public:
  /// `use_beats`: R peaks set the phase. Without `fallback` nothing is predicted while the phases are not locked, with
  /// it an autoregressive one does.
  Harmonic(const PredictorOptions& options, bool use_beats, bool fallback);

  void observe(const MotionSample& sample) override;
  void observe_beat(double r_peak_s) override { tracker_.observe_beat(r_peak_s); }
  Prediction predict(double time_s) const override;

  bool locked() const { return tracker_.locked(); }

 private:
  void watch(const FourierMotion::Axes& position);

  mutable HarmonicTracker tracker_;  // predicting writes into its workspace
  std::unique_ptr<MotionPredictor> plain_;
  HorizonErrors errors_;
  double time_s_ = 0;
  bool seen_ = false;
};

}  // namespace heartservo::servo
