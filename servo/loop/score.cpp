#include "servo/loop/score.hpp"

#include <algorithm>
#include <cmath>

#include "servo/loop/loop_record.hpp"

namespace heartservo::servo {

using tracking::TrackState;

namespace {

constexpr double kPressSettle_s = 0.5;  // the force is scored from then on

template <class Vector>
double rms_around_mean(const std::vector<Vector>& points) {
  if (points.empty()) return 0;
  Vector mean = Vector::Zero();
  for (const auto& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  double sum = 0;
  for (const auto& p : points) sum += (p - mean).squaredNorm();
  return std::sqrt(sum / static_cast<double>(points.size()));
}

double reduction_percent(double residual_rms, double motion_rms) {
  return motion_rms > 0 ? 100 * (1 - residual_rms / motion_rms) : 0;
}

}  // namespace

double percentile(std::vector<double> values, double p) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double at = std::clamp(p / 100, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

Spread spread_of(std::vector<double> values) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
  Spread s;
  s.count = values.size();
  if (values.empty()) return s;
  const auto n = static_cast<double>(values.size());
  double sum = 0, squares = 0;
  for (const double v : values) {
    sum += v;
    squares += v * v;
    s.max = std::max(s.max, std::abs(v));
  }
  s.mean = sum / n;
  s.rms = std::sqrt(squares / n);
  double around = 0;
  for (double& v : values) {
    around += (v - s.mean) * (v - s.mean);
    v = std::abs(v);
  }
  s.std = std::sqrt(around / n);
  s.p95 = percentile(std::move(values), 95);
  return s;
}

void Score::reserve(std::size_t frames) {
  goals_.reserve(frames), residuals_.reserve(frames), position_errors_.reserve(frames);
  goals_px_.reserve(frames), residuals_px_.reserve(frames), corner_errors_px_.reserve(frames);
  track_ms_.reserve(frames), chain_ms_.reserve(frames);
}

void Score::add(const LoopRecord& r, const TruthSample& truth) {
  ++counts_.frames;
  if (!first_time_s_) first_time_s_ = r.frame.time_s;
  counts_.lost_frames += r.track.state == TrackState::LOST;
  counts_.uncertain_frames += r.track.state == TrackState::UNCERTAIN;
  counts_.relocks += r.track.reacquired;
  counts_.unreadable_frames += r.frame.status != tracking::FrameStatus::OK;
  counts_.limited_commands += r.guard.limited();
  counts_.max_speed = std::max(counts_.max_speed, r.command.velocity.norm());
  counts_.max_step_m = std::max(counts_.max_step_m, r.command.velocity.norm() * period_s_);
  track_ms_.push_back(r.track_ms);
  chain_ms_.push_back(r.chain_ms);

  if (truth.corners_px && r.track.state != TrackState::LOST) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += (r.track.corners[i] - (*truth.corners_px)[i]).norm();
    corner_errors_px_.push_back(sum / 4);
  }
  if (truth.target && r.target.state != TrackState::LOST)
    position_errors_.push_back(r.target.T_camera_target.translation() - *truth.target);

  if (truth.force_n) {
    counts_.force_peak_n = std::max(counts_.force_peak_n, *truth.force_n);
    counts_.touches += *truth.force_n > 0 && last_force_n_ <= 0;
    last_force_n_ = *truth.force_n;
    pressing_s_ = r.force_wanted_n > 0 ? pressing_s_ + period_s_ : 0;
    if (pressing_s_ > kPressSettle_s) force_errors_.push_back(*truth.force_n - r.force_wanted_n);
  }
  if (r.frame.time_s - *first_time_s_ < settle_s_) return;
  ++counts_.scored_frames;
  if (truth.goal && truth.tip) {
    goals_.push_back(*truth.goal);
    residuals_.push_back(*truth.tip - *truth.goal);
  }
  if (truth.goal_px.allFinite()) {
    goals_px_.push_back(truth.goal_px);
    residuals_px_.push_back((truth.tip_px - truth.goal_px).norm());
  }
}

ScoreSummary Score::summary() const {
  ScoreSummary s = counts_;
  s.metric = !residuals_.empty();
  std::vector<double> norms;
  norms.reserve(residuals_.size());
  Eigen::Vector3d low = Eigen::Vector3d::Constant(INFINITY), high = -low;
  for (std::size_t i = 0; i < residuals_.size(); ++i) {
    norms.push_back(residuals_[i].norm());
    s.residual_axis_rms += residuals_[i].cwiseAbs2();
    low = low.cwiseMin(goals_[i]);
    high = high.cwiseMax(goals_[i]);
  }
  if (s.metric) {
    s.residual_axis_rms = (s.residual_axis_rms / static_cast<double>(residuals_.size())).cwiseSqrt();
    s.motion_peak_to_peak = high - low;
  }
  s.residual = spread_of(std::move(norms));
  s.motion_rms = rms_around_mean(goals_);
  s.reduction_percent = reduction_percent(s.residual.rms, s.motion_rms);
  s.residual_px = spread_of(residuals_px_);
  s.force_error = spread_of(force_errors_);
  s.motion_px.rms = rms_around_mean(goals_px_);
  s.reduction_percent_px = reduction_percent(s.residual_px.rms, s.motion_px.rms);
  s.corner_error_px = spread_of(corner_errors_px_);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> errors;
    errors.reserve(position_errors_.size());
    for (const auto& e : position_errors_) errors.push_back(e[axis]);
    const Spread spread = spread_of(std::move(errors));
    s.position_error_std[axis] = spread.std;
    s.position_error_max[axis] = spread.max;
  }
  s.track_ms_p50 = percentile(track_ms_, 50), s.track_ms_p99 = percentile(track_ms_, 99);
  s.track_ms_max = percentile(track_ms_, 100);
  s.chain_ms_p50 = percentile(chain_ms_, 50), s.chain_ms_p99 = percentile(chain_ms_, 99);
  s.chain_ms_max = percentile(chain_ms_, 100);
  return s;
}

}  // namespace heartservo::servo
