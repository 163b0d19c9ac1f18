// The harmonic model as a predictor: while it is not locked, a constant acceleration.
#include <algorithm>
#include <cmath>

#include "servo/prediction/harmonic_tracker.hpp"
#include "servo/prediction/registry.hpp"

namespace heartservo::servo {

namespace {

class Harmonic final : public MotionPredictor {
 public:
  Harmonic(const PredictorOptions& options, bool use_beats)
      : tracker_(harmonic_options(options, use_beats)), fallback_(make_constant_acceleration(options)), errors_(0.064, 2) {}

  void observe(const MotionSample& sample) override {
    if (!sample.position.allFinite() || !std::isfinite(sample.time_s)) return;
    if (seen_ && !(sample.time_s > time_s_)) return;
    const FourierMotion::Axes position = sample.position.transpose();
    errors_.observe(sample.time_s, position);
    tracker_.observe(sample.time_s, position, sample.covariance.diagonal().transpose());
    fallback_->observe(sample);
    time_s_ = sample.time_s;
    seen_ = true;
    watch();
  }

  void observe_beat(double r_peak_s) override { tracker_.observe_beat(r_peak_s); }

  Prediction predict(double time_s) const override {
    Prediction p = fallback_->predict(time_s);
    if (!tracker_.locked()) return p;
    const HarmonicEstimate e = tracker_.predict(time_s);
    if (!e.position.allFinite() || !e.velocity.allFinite() || !e.variance.allFinite()) return p;
    p.valid = true;
    p.position = e.position.transpose();
    p.velocity = e.velocity.transpose();
    p.covariance = e.variance.transpose().asDiagonal();
    return p;
  }

 private:
  // Lost: for a while no better than a constant acceleration.
  void watch() {
    auto& foreseen = errors_.predictions(time_s_);
    foreseen[0].setConstant(NAN);
    if (tracker_.locked()) foreseen[0] = tracker_.predict(time_s_ + errors_.horizon_s()).position;
    foreseen[1] = fallback_->predict(time_s_ + errors_.horizon_s()).position.transpose();
    if (tracker_.locked() && errors_.experience_s(0) > 1 && errors_.fast(0) > 1.5 * errors_.fast(1) && errors_.slow(0) > errors_.slow(1)) {
      tracker_.search_again();
      errors_.forget();
    }
  }

  mutable HarmonicTracker tracker_;  // predicting writes into its workspace
  std::unique_ptr<MotionPredictor> fallback_;
  HorizonErrors errors_;
  double time_s_ = 0;
  bool seen_ = false;
};

}  // namespace

std::unique_ptr<MotionPredictor> make_harmonic(const PredictorOptions& options) {
  return std::make_unique<Harmonic>(options, false);
}

std::unique_ptr<MotionPredictor> make_harmonic_ecg(const PredictorOptions& options) {
  return std::make_unique<Harmonic>(options, true);
}

}  // namespace heartservo::servo
