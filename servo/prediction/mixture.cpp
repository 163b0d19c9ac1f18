// All predictors side by side, weighted by how well each foresaw the last seconds at the horizon that is asked for: an
// equivalent of interacting multiple models (Blom and Bar-Shalom 1988) whose members need not share a state, and whose
// evidence is the error at the real horizon instead of one step's. A harmonic model that has lost its phase loses its
// weight within half a second, and gets it back when it is locked again.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "servo/prediction/harmonic_tracker.hpp"
#include "servo/prediction/horizon_errors.hpp"
#include "servo/prediction/registry.hpp"

namespace heartservo::servo {

namespace {

constexpr std::array<double, 5> kHorizons_s{0.016, 0.032, 0.064, 0.128, 0.256};
constexpr double kSharpness = 4;  // weights go with the mean squared error to this power

class Mixture final : public MotionPredictor {
 public:
  explicit Mixture(const PredictorOptions& options) : least_(options.smallest_sigma_m) {
    members_.push_back(make_hold(options));
    members_.push_back(make_constant_velocity(options));
    members_.push_back(make_constant_acceleration(options));
    members_.push_back(make_autoregressive(options));
    members_.push_back(make_harmonic(options));
    members_.push_back(make_harmonic_ecg(options));
    for (const double horizon : kHorizons_s) errors_.emplace_back(horizon, members_.size());
  }

  void observe(const MotionSample& sample) override {
    if (!sample.position.allFinite() || !std::isfinite(sample.time_s)) return;
    if (seen_ > 0 && !(sample.time_s > time_s_)) return;
    const Axes position = sample.position.transpose();
    for (auto& errors : errors_) errors.observe(sample.time_s, position);
    for (std::size_t i = 0; i < members_.size(); ++i)
      if (i != kEcg || beats_) members_[i]->observe(sample);
    period_s_ = seen_ == 0 ? 0.008 : seen_ == 1 ? sample.time_s - time_s_ : period_s_ + 0.05 * std::min(0.0, sample.time_s - time_s_ - period_s_) + 0.005 * std::clamp(sample.time_s - time_s_ - period_s_, 0.0, period_s_);
    time_s_ = sample.time_s;
    ++seen_;
    for (auto& errors : errors_) {
      auto& foreseen = errors.predictions(time_s_);
      for (std::size_t i = 0; i < members_.size(); ++i) {
        foreseen[i].setConstant(NAN);
        if (i == kEcg && !beats_) continue;
        const Prediction p = members_[i]->predict(time_s_ + errors.horizon_s());
        if (p.valid) foreseen[i] = p.position.transpose();
      }
    }
  }

  void observe_beat(double r_peak_s) override {
    if (!std::isfinite(r_peak_s)) return;
    beats_ = true;
    members_[kEcg]->observe_beat(r_peak_s);
  }

  Prediction predict(double time_s) const override {
    Prediction result;
    result.time_s = time_s;
    const double horizon = std::max(time_s - time_s_, 0.8 * period_s_);
    // between two horizons that are watched, the shares are those of both
    std::size_t upper = 0;
    while (upper + 1 < kHorizons_s.size() && kHorizons_s[upper] < horizon) ++upper;
    const std::size_t lower = upper > 0 && kHorizons_s[upper - 1] > 0.8 * period_s_ ? upper - 1 : upper;
    const double share = lower == upper ? 1 : std::clamp(std::log(horizon / kHorizons_s[lower]) / std::log(kHorizons_s[upper] / kHorizons_s[lower]), 0.0, 1.0);
    std::array<Prediction, kMembers> p;
    std::array<double, kMembers> weight{};
    for (std::size_t i = 0; i < kMembers; ++i) {
      if (i == kEcg && !beats_) continue;
      p[i] = members_[i]->predict(time_s);
      if (!p[i].valid || !p[i].position.allFinite() || !p[i].velocity.allFinite() || !p[i].covariance.allFinite()) continue;
      const double squared = (1 - share) * squared_error(lower, i) + share * squared_error(upper, i);
      weight[i] = std::isfinite(squared) ? std::pow(squared + 1e-12, -kSharpness) : i == kFirst ? 1e-300 : 0;
    }
    double total = 0;
    for (const double w : weight) total += w;
    if (!(total > 0) || !std::isfinite(total)) return result;
    result.valid = true;
    for (std::size_t i = 0; i < kMembers; ++i) {
      if (!(weight[i] > 0)) continue;
      result.position += weight[i] / total * p[i].position;
      result.velocity += weight[i] / total * p[i].velocity;
    }
    for (std::size_t i = 0; i < kMembers; ++i) {
      if (!(weight[i] > 0)) continue;
      const Eigen::Vector3d off = p[i].position - result.position;
      result.covariance += weight[i] / total * (p[i].covariance + off * off.transpose());
    }
    return result;
  }

 private:
  using Axes = HorizonErrors::Axes;
  static constexpr std::size_t kMembers = 6, kFirst = 1, kEcg = 5;

  // The worse of what is long and what is recent: a member that has just failed is out at once.
  double squared_error(std::size_t horizon, std::size_t member) const {
    const HorizonErrors& e = errors_[horizon];
    return 0.5 * (e.fast(member) + e.slow(member));
  }

  std::vector<std::unique_ptr<MotionPredictor>> members_;
  std::vector<HorizonErrors> errors_;
  double time_s_ = 0, period_s_ = 0.008, least_;
  long seen_ = 0;
  bool beats_ = false;
};

}  // namespace

std::unique_ptr<MotionPredictor> make_mixture(const PredictorOptions& options) {
  return std::make_unique<Mixture>(options);
}

}  // namespace heartservo::servo
