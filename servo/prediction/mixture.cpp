// All predictors side by side, mixed as would have been best for what came lately at the horizon that is asked for: an
// equivalent of interacting multiple models (Blom and Bar-Shalom 1988) whose members need not share a state, and whose
// evidence is the error at the real horizon instead of one step's. A harmonic model that has lost its phase loses its
// weight within half a second, and gets it back when it is locked again.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "servo/prediction/harmonic.hpp"

namespace heartservo::servo {

namespace {

constexpr std::array<double, 5> kHorizons_s{0.016, 0.032, 0.064, 0.128, 0.256};

class Mixture final : public MotionPredictor {
 public:
  explicit Mixture(const PredictorOptions& options) {
    members_.push_back(make_constant_velocity(options));
    members_.push_back(make_hold(options));
    members_.push_back(make_constant_acceleration(options));
    members_.push_back(make_autoregressive(options));
    members_.push_back(make_analogue(options));
    members_.push_back(std::make_unique<Harmonic>(options, false, false));
    members_.push_back(std::make_unique<Harmonic>(options, true, false));
    for (const double horizon : kHorizons_s) errors_.emplace_back(horizon, kMembers);
  }

  void observe(const MotionSample& sample) override {
    if (!sample.position.allFinite() || !std::isfinite(sample.time_s)) return;
    if (seen_ > 0 && !(sample.time_s > time_s_)) return;
    for (int i = 0; i < kMembers; ++i)
      if (takes_part(i)) member(i).observe(sample);
    const double dt = sample.time_s - time_s_;
    if (seen_ == 1) period_s_ = dt;
    if (seen_ > 1) period_s_ += dt < period_s_ ? 0.05 * (dt - period_s_) : 0.005 * std::min(dt - period_s_, period_s_);
    if (seen_ > 1 && dt > std::max(4 * period_s_, kGap_s)) back_since_s_ = sample.time_s;
    time_s_ = sample.time_s;
    ++seen_;
    position_ = sample.position;
    const long every = std::clamp(std::lround(0.016 / period_s_), 1l, 4l);
    for (std::size_t h = 0; h < errors_.size(); ++h) {
      HorizonErrors& errors = errors_[h];
      if (errors.horizon_s() < 0.8 * period_s_) continue;  // nobody would ask
      errors.observe(sample.time_s, sample.position.transpose());
      if ((seen_ + static_cast<long>(h)) % every != 0) continue;  // fast samples need not all be judged
      auto& foreseen = errors.predictions(time_s_);
      foreseen.setConstant(NAN);
      for (int i = 0; i < kMembers; ++i) {
        if (!takes_part(i)) continue;
        const Prediction p = member(i).predict(time_s_ + errors.horizon_s());
        if (p.valid) foreseen.row(i) = p.position.transpose();
      }
      errors.weigh();
    }
  }

  void observe_beat(double r_peak_s) override {
    if (!std::isfinite(r_peak_s)) return;
    beats_ = true;
    member(kEcg).observe_beat(r_peak_s);
  }

  Prediction predict(double time_s) const override {
    HorizonErrors::Weights w = weights_at(time_s - time_s_);
    distrust_the_short_sighted(w);
    Prediction result;
    result.time_s = time_s;
    std::array<Prediction, kMembers> p;
    double total = 0;
    for (int i = 0; i < kMembers; ++i) {
      Prediction& one = p[static_cast<std::size_t>(i)];
      if (w[i] > 1e-4) one = member(i).predict(time_s);
      if (!one.position.allFinite() || !one.velocity.allFinite() || !one.covariance.allFinite()) one.valid = false;
      if (!one.valid) continue;
      total += w[i];
      result.position += w[i] * one.position;
      result.velocity += w[i] * one.velocity;
    }
    if (!(total > 1e-3)) return member(0).predict(time_s);
    result.valid = true;
    result.position /= total;
    result.velocity /= total;
    stay_near(result, time_s - time_s_);
    for (int i = 0; i < kMembers; ++i) {
      const Prediction& one = p[static_cast<std::size_t>(i)];
      if (!one.valid) continue;
      const Eigen::Vector3d off = one.position - result.position;
      result.covariance += w[i] / total * (one.covariance + off * off.transpose());
    }
    return result;
  }

 private:
  static constexpr int kMembers = 7, kHold = 1, kEcg = 6;
  static constexpr std::array<int, 4> kShortSighted{0, 2, 3, 4};
  static constexpr double kFarther = 1.3, kExperience_s = 3, kGap_s = 0.03, kBack_s = 0.1;

  MotionPredictor& member(int i) const { return *members_[static_cast<std::size_t>(i)]; }
  bool takes_part(int i) const { return i != kEcg || beats_; }

  // The heart has hardly ever gone farther in that time than it did of late.
  void stay_near(Prediction& p, double horizon) const {
    for (const HorizonErrors& errors : errors_) {
      if (errors.horizon_s() < horizon || errors.experience_s(kHold) < kExperience_s) continue;
      const Eigen::Vector3d way = p.position - position_;
      const double farthest = kFarther * errors.largest(kHold);
      if (way.norm() > farthest) p.position = position_ + way * (farthest / way.norm());
      return;
    }
  }

  // After a gap the members that go by the last few samples have none of them, and their errors are not known yet: for
  // a while only the heart's rhythm counts, and without one where the target is.
  void distrust_the_short_sighted(HorizonErrors::Weights& w) const {
    const double back_s = time_s_ - back_since_s_;
    if (!(back_s < kBack_s)) return;
    for (const int i : kShortSighted) w[i] *= (back_s / kBack_s) * (back_s / kBack_s);
    w[kHold] += 2e-3;
  }

  // Between two horizons that are watched, shares of both.
  HorizonErrors::Weights weights_at(double horizon) const {
    std::size_t lower = 0;
    while (lower + 1 < errors_.size() && errors_[lower].horizon_s() < 0.8 * period_s_) ++lower;
    std::size_t upper = lower;
    while (upper + 1 < errors_.size() && errors_[upper].horizon_s() < horizon) ++upper;
    lower = upper > lower ? upper - 1 : upper;
    const HorizonErrors &a = errors_[lower], &b = errors_[upper];
    if (lower == upper) return a.weights();
    const double share =
        std::clamp(std::log(horizon / a.horizon_s()) / std::log(b.horizon_s() / a.horizon_s()), 0.0, 1.0);
    return (1 - share) * a.weights() + share * b.weights();
  }

  std::vector<std::unique_ptr<MotionPredictor>> members_;
  std::vector<HorizonErrors> errors_;
  double time_s_ = 0, period_s_ = 0.008, back_since_s_ = -INFINITY;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
  long seen_ = 0;
  bool beats_ = false;
};

}  // namespace

std::unique_ptr<MotionPredictor> make_mixture(const PredictorOptions& options) {
  return std::make_unique<Mixture>(options);
}

}  // namespace heartservo::servo
