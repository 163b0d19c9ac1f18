#include "servo/prediction/harmonic.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::servo {

namespace {

constexpr double kWatched_s = 0.064;  // the horizon at which the model must be worth its name
constexpr double kLost = 0.4;         // of the mean squared distance that the heart moves meanwhile

}  // namespace

Harmonic::Harmonic(const PredictorOptions& options, bool use_beats, bool fallback)
    : tracker_(harmonic_options(options, use_beats)),
      plain_(fallback ? make_autoregressive(options) : nullptr),
      errors_(kWatched_s, 2) {}

void Harmonic::observe(const MotionSample& sample) {
  if (!sample.position.allFinite() || !std::isfinite(sample.time_s)) return;
  if (seen_ && !(sample.time_s > time_s_)) return;
  const FourierMotion::Axes position = sample.position.transpose();
  errors_.observe(sample.time_s, position);
  tracker_.observe(sample.time_s, position, sample.covariance.diagonal().transpose());
  if (plain_) plain_->observe(sample);
  time_s_ = sample.time_s;
  seen_ = true;
  watch(position);
}

Prediction Harmonic::predict(double time_s) const {
  Prediction p;
  p.time_s = time_s;
  if (tracker_.locked()) {
    const HarmonicEstimate e = tracker_.predict(time_s);
    if (e.position.allFinite() && e.velocity.allFinite() && e.variance.allFinite()) {
      p.valid = true;
      p.position = e.position.transpose();
      p.velocity = e.velocity.transpose();
      p.covariance = e.variance.transpose().asDiagonal();
      return p;
    }
  }
  return plain_ ? plain_->predict(time_s) : p;
}

// Lost: for a while not much better than the last position, at a horizon over which the heart has moved.
void Harmonic::watch(const FourierMotion::Axes& position) {
  auto& foreseen = errors_.predictions(time_s_);
  foreseen.row(0).setConstant(NAN);
  if (tracker_.locked()) foreseen.row(0) = tracker_.predict(time_s_ + errors_.horizon_s()).position;
  foreseen.row(1) = position;
  if (tracker_.locked() && errors_.experience_s(0) > 1 && errors_.fast(0) > kLost * errors_.fast(1) &&
      errors_.slow(0) > kLost * errors_.slow(1)) {
    tracker_.search_again();
    errors_.forget();
  }
}

std::unique_ptr<MotionPredictor> make_harmonic(const PredictorOptions& options) {
  return std::make_unique<Harmonic>(options, false, true);
}

std::unique_ptr<MotionPredictor> make_harmonic_ecg(const PredictorOptions& options) {
  return std::make_unique<Harmonic>(options, true, true);
}

}  // namespace heartservo::servo
