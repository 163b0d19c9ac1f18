// Each axis foreseen from its own last samples by linear combinations whose coefficients are learned by recursive least
// squares, for each horizon its own (direct multi-step prediction):
//
//   p(t + h) - p(t) = sum_i w_h,i (p(t - i) - p(t - i - 1))
//
// All horizons have the same regressors, only later: the gain of a moment is kept until what was to be foreseen has
// come true (Haykin, Adaptive Filter Theory, chapter 10, for the recursion). Samples are put on a grid of equal steps;
// gaps are filled with what was foreseen.
#include <algorithm>
#include <array>
#include <cmath>

#include "servo/prediction/registry.hpp"

namespace heartservo::servo {

namespace {

constexpr int kOrder = 16;
constexpr std::array<int, 8> kHorizons{1, 2, 3, 5, 8, 12, 18, 26};  // steps
constexpr int kLongest = kHorizons.back();
constexpr double kShortestStep_s = 0.008, kMemory_s = 20;
constexpr int kMostFilled = 125;  // steps of a gap that are filled

using Vector = Eigen::Matrix<double, kOrder, 1>;
using Matrix = Eigen::Matrix<double, kOrder, kOrder>;

/// One axis on its grid.
class Axis {
 public:
  void start(double position) {
    past_.fill(position);
    P_ = 1e4 * Matrix::Identity();
    for (auto& w : w_) w.setZero();
    for (auto& e : error_) e = 0;
    count_ = 0;
  }

  void add(double position, double scale, double forget, bool learn) {
    for (std::size_t i = past_.size() - 1; i > 0; --i) past_[i] = past_[i - 1];
    past_[0] = position;
    ++count_;
    // what was foreseen `h` steps ago has come true
    if (learn)
      for (std::size_t k = 0; k < kHorizons.size(); ++k) {
        const int h = kHorizons[k];
        if (count_ <= kOrder + h) continue;
        const Step& then = steps_[static_cast<std::size_t>((count_ - h) % kRing)];
        if (!then.learn) continue;
        const double off = position - past_[static_cast<std::size_t>(h)] - w_[k].dot(then.x);
        w_[k] += then.gain * off;
        error_[k] += (1 - forget) * 8 * (off * off - error_[k]);
      }
    Step& now = steps_[static_cast<std::size_t>(count_ % kRing)];
    for (int i = 0; i < kOrder; ++i)
      now.x[i] = past_[static_cast<std::size_t>(i)] - past_[static_cast<std::size_t>(i + 1)];
    now.learn = learn && count_ > kOrder;
    if (!now.learn) return;
    const Vector x = now.x / scale, Px = P_ * x;
    const double s = forget + x.dot(Px);
    now.gain = Px / (s * scale);
    P_ = ((P_ - Px * Px.transpose() / s) / forget).eval();
    P_ = (0.5 * (P_ + P_.transpose())).eval();
    if (const double trace = P_.trace(); trace > 1e6 * kOrder) P_ *= 1e6 * kOrder / trace;
  }

  /// After `steps`, from the horizons around: a parabola through three of them (0 among them).
  double at(double steps, double& slope, double& variance) const {
    std::array<double, kHorizons.size() + 1> h{}, y{};
    const Vector& x = steps_[static_cast<std::size_t>(count_ % kRing)].x;
    for (std::size_t k = 0; k < kHorizons.size(); ++k) {
      h[k + 1] = kHorizons[k];
      y[k + 1] = w_[k].dot(x);
    }
    std::size_t i = 1;
    while (i + 1 < kHorizons.size() && h[i + 1] < steps) ++i;
    const double a = h[i - 1], b = h[i], c = h[i + 1], t = std::min(steps, h.back());
    const double la = (t - b) * (t - c) / ((a - b) * (a - c)), lb = (t - a) * (t - c) / ((b - a) * (b - c)),
                 lc = (t - a) * (t - b) / ((c - a) * (c - b));
    slope = y[i - 1] * (2 * t - b - c) / ((a - b) * (a - c)) + y[i] * (2 * t - a - c) / ((b - a) * (b - c)) +
            y[i + 1] * (2 * t - a - b) / ((c - a) * (c - b));
    variance = error_[std::min(i, error_.size() - 1)];
    return past_[0] + la * y[i - 1] + lb * y[i] + lc * y[i + 1];
  }

 private:
  static constexpr int kRing = 32;
  struct Step {
    Vector x = Vector::Zero(), gain = Vector::Zero();
    bool learn = false;
  };
  static_assert(kRing > kLongest);

  std::array<double, kOrder + kLongest + 1> past_{};
  std::array<Step, kRing> steps_;
  std::array<Vector, kHorizons.size()> w_;
  std::array<double, kHorizons.size()> error_{};
  Matrix P_;
  long count_ = 0;
};

class Autoregressive final : public MotionPredictor {
 public:
  explicit Autoregressive(const PredictorOptions& options) : least_(options.smallest_sigma_m) {}

  void observe(const MotionSample& sample) override {
    if (!sample.position.allFinite() || !std::isfinite(sample.time_s)) return;
    if (seen_ > 0 && !(sample.time_s > time_s_)) return;
    if (seen_ > 0 && seen_ < kFirst)
      step_s_ = seen_ == 1 ? sample.time_s - time_s_ : std::min(step_s_, sample.time_s - time_s_);
    if (seen_ == kFirst - 1) {
      // that of a sample is never hit exactly: samples as they come make the grid
      step_s_ = std::max(step_s_, kShortestStep_s);
      restart(sample);
    } else if (seen_ >= kFirst) {
      if (sample.time_s - grid_s_ > kMostFilled * step_s_)
        restart(sample);
      else
        fill_grid(sample);
    }
    time_s_ = sample.time_s;
    position_ = sample.position;
    ++seen_;
  }

  Prediction predict(double time_s) const override {
    Prediction p;
    p.valid = seen_ > 0;
    p.time_s = time_s;
    p.position = position_;
    p.covariance = Eigen::Matrix3d::Identity() * least_ * least_;
    if (steps_ <= 2 * kOrder) return p;
    const double steps = std::max(0.0, (time_s - grid_s_) / step_s_);
    for (int i = 0; i < 3; ++i) {
      double slope = 0, variance = 0;
      const double at = axes_[static_cast<std::size_t>(i)].at(steps, slope, variance);
      if (!std::isfinite(at) || !std::isfinite(slope)) continue;
      p.position[i] = at;
      p.velocity[i] = slope / step_s_;
      p.covariance(i, i) += std::isfinite(variance) ? variance : 0;
    }
    return p;
  }

 private:
  static constexpr long kFirst = 8;  // samples that show the step

  void restart(const MotionSample& sample) {
    for (int i = 0; i < 3; ++i) axes_[static_cast<std::size_t>(i)].start(sample.position[i]);
    grid_s_ = sample.time_s;
    steps_ = 0;
    scale_ = Eigen::Vector3d::Constant(1e-4);
  }

  void fill_grid(const MotionSample& sample) {
    const double forget = std::exp(-step_s_ / kMemory_s);
    const bool gap = sample.time_s - time_s_ > 2.5 * step_s_;
    while (grid_s_ + step_s_ <= sample.time_s + 0.02 * step_s_) {
      grid_s_ += step_s_;
      // a sample that comes a little early or late by the clock's grain is taken as it is
      const bool here = std::abs(sample.time_s - grid_s_) < 0.02 * step_s_;
      const double share = here ? 1 : std::clamp((grid_s_ - time_s_) / (sample.time_s - time_s_), 0.0, 1.0);
      for (int i = 0; i < 3; ++i) {
        Axis& axis = axes_[static_cast<std::size_t>(i)];
        double value = position_[i] + share * (sample.position[i] - position_[i]);
        if (gap && !here) {
          double slope = 0, variance = 0;
          value = axis.at(1, slope, variance);
          if (!std::isfinite(value) || std::abs(value - position_[i]) > 0.05) value = position_[i];
        }
        axis.add(value, scale_[i], forget, !gap);
      }
      if (here) grid_s_ = sample.time_s;
      ++steps_;
    }
    for (int i = 0; i < 3; ++i) {
      const double moved = std::abs(sample.position[i] - position_[i]);
      scale_[i] = std::max(1e-6, scale_[i] + 0.002 * (moved - scale_[i]));
    }
  }

  std::array<Axis, 3> axes_;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero(), scale_ = Eigen::Vector3d::Constant(1e-4);
  double time_s_ = 0, grid_s_ = 0, step_s_ = 0.008, least_;
  long seen_ = 0, steps_ = 0;
};

}  // namespace

std::unique_ptr<MotionPredictor> make_autoregressive(const PredictorOptions& options) {
  return std::make_unique<Autoregressive>(options);
}

}  // namespace heartservo::servo
