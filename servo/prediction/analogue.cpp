// What came after the moments that were most like now (Lorenz, "Atmospheric predictability as revealed by naturally
// occurring analogues", J. Atmos. Sci. 26, 1969). The last third of a second is looked for in the last ten seconds, up
// to a displacement that is free; the motion is foreseen to go on as it did after the three best. It needs no rates and
// no steady beat, only a heart that moves as it moved before.
#include <algorithm>
#include <array>
#include <cmath>

#include "servo/prediction/registry.hpp"
#include "servo/prediction/uniform_track.hpp"

namespace heartservo::servo {

namespace {

constexpr double kStep_s = 0.032, kPattern_s = 0.34, kHistory_s = 10, kLeastShift_s = 0.3;
constexpr int kMost = 320, kFound = 3, kFirst = 8;

class Analogue final : public MotionPredictor {
 public:
  explicit Analogue(const PredictorOptions& options) : track_(kMost), least_(options.smallest_sigma_m) {}

  void observe(const MotionSample& sample) override {
    if (!sample.position.allFinite() || !std::isfinite(sample.time_s)) return;
    if (seen_ > 0 && !(sample.time_s > time_s_)) return;
    if (seen_ > 0 && seen_ < kFirst)
      step_s_ = seen_ == 1 ? sample.time_s - time_s_ : std::min(step_s_, sample.time_s - time_s_);
    if (++seen_ == kFirst) track_.restart(std::max(kStep_s, step_s_));
    time_s_ = sample.time_s;
    position_ = sample.position.transpose();
    if (seen_ >= kFirst && track_.add(time_s_, position_) > 0) search();
  }

  Prediction predict(double time_s) const override {
    Prediction p;
    p.valid = seen_ > 0;
    p.time_s = time_s;
    p.position = position_.transpose();
    p.covariance = Eigen::Matrix3d::Identity() * (least_ * least_ + spread_);
    if (found_ == 0) return p;
    const double ahead = std::max(0.0, (time_s - track_.end_s()) / track_.step_s());
    Axes position = Axes::Zero(), velocity = Axes::Zero();
    for (int k = 0; k < found_; ++k) {
      const Match& m = matches_[static_cast<std::size_t>(k)];
      // as far as is known; then again from the shift before
      const double back = std::max(m.shift - ahead, 0.0);
      const int i = std::min(static_cast<int>(back), m.shift - 1);
      const double share = back - i;
      position += m.weight * ((1 - share) * track_.at(i) + share * track_.at(i + 1) + m.offset);
      velocity += m.weight * (track_.at(i) - track_.at(i + 1)) / track_.step_s();
    }
    p.position = position.transpose();
    p.velocity = velocity.transpose();
    return p;
  }

 private:
  using Axes = UniformTrack::Axes;
  struct Match {
    int shift = 0;
    double cost = 0, weight = 0;
    Axes offset = Axes::Zero();
  };

  void search() {
    found_ = 0;
    const int length = std::max(5, static_cast<int>(std::lround(kPattern_s / track_.step_s())));
    const int first = std::max(2, static_cast<int>(kLeastShift_s / track_.step_s())),
              last = std::min({track_.size(), kMost, static_cast<int>(kHistory_s / track_.step_s())}) - length - 1;
    if (last - first < 10) return;
    for (int shift = first; shift <= last; ++shift) cost_[static_cast<std::size_t>(shift)] = cost(shift, length);
    for (int shift = first + 1; shift < last; ++shift) {
      const double c = cost_[static_cast<std::size_t>(shift)];
      if (c > cost_[static_cast<std::size_t>(shift - 1)] || c > cost_[static_cast<std::size_t>(shift + 1)]) continue;
      if (found_ == kFound && c >= matches_[kFound - 1].cost) continue;
      int at = found_ < kFound ? found_++ : kFound - 1;
      for (; at > 0 && matches_[static_cast<std::size_t>(at - 1)].cost > c; --at)
        matches_[static_cast<std::size_t>(at)] = matches_[static_cast<std::size_t>(at - 1)];
      matches_[static_cast<std::size_t>(at)] = {shift, c, 0, Axes::Zero()};
    }
    double total = 0;
    for (int k = 0; k < found_; ++k) {
      Match& m = matches_[static_cast<std::size_t>(k)];
      m.weight = 1 / (m.cost + 1e-12);
      total += m.weight;
      for (int i = 0; i < 3; ++i) m.offset += (track_.at(i) - track_.at(i + m.shift)) / 3;
    }
    for (int k = 0; k < found_; ++k) matches_[static_cast<std::size_t>(k)].weight /= total;
    spread_ = found_ > 0 ? matches_[0].cost : 0;
  }

  double cost(int shift, int length) const {
    Axes mean = Axes::Zero();
    double squares = 0;
    for (int i = 0; i < length; ++i) {
      const Axes off = track_.at(i) - track_.at(i + shift);
      mean += off;
      squares += off.squaredNorm();
    }
    return squares / length - mean.squaredNorm() / (length * length);
  }

  UniformTrack track_;
  std::array<double, kMost + 1> cost_{};
  std::array<Match, kFound> matches_;
  int found_ = 0;
  double time_s_ = 0, step_s_ = kStep_s, spread_ = 0, least_;
  Axes position_ = Axes::Zero();
  long seen_ = 0;
};

}  // namespace

std::unique_ptr<MotionPredictor> make_analogue(const PredictorOptions& options) {
  return std::make_unique<Analogue>(options);
}

}  // namespace heartservo::servo
