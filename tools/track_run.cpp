#include "tools/track_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "servo/loop/score.hpp"
#include "tools/servo_summary.hpp"
#include "tracking/frames/frame.hpp"

namespace heartservo::tools {

using nlohmann::json;
using tracking::TrackState;

namespace {

std::vector<std::string> column_names(bool metric) {
  std::vector<std::string> names{"time_s", "frame/sequence", "track/state", "track/quality"};
  for (int i = 0; i < 4; ++i)
    for (const char* axis : {"u_px", "v_px"}) names.push_back(fmt::format("track/corner{}/{}", i, axis));
  for (const char* name : {"displacement/u_px", "displacement/v_px", "error_px", "timing/track_ms"})
    names.emplace_back(name);
  if (metric)
    for (const char* name :
         {"measured/x_m", "measured/y_m", "measured/z_m", "pose/qx", "pose/qy", "pose/qz", "pose/qw"})
      names.emplace_back(name);
  return names;
}

constexpr double kWrong_px = 5;  // a region further off than this is another region

json extent(const std::vector<double>& values) {
  const auto s = servo::spread_of(values);
  if (values.empty()) return nullptr;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {{"min", *low}, {"max", *high}, {"peak_to_peak", *high - *low}, {"rms", s.std}};
}

}  // namespace

TrackLane::TrackLane(std::string name, std::unique_ptr<tracking::TargetTracker> tracker,
                     std::unique_ptr<tracking::TargetEstimator> estimator, std::size_t frames)
    : name_(std::move(name)),
      tracker_(std::move(tracker)),
      estimator_(std::move(estimator)),
      table_(column_names(estimator_ != nullptr), frames) {}

std::string TrackLane::start(const tracking::Frame& frame, const tracking::Quad& region) {
  start_px_ = tracking::centre(region);
  return tracker_->start(frame, region);
}

const tracking::Track& TrackLane::follow(const tracking::Frame& frame, const tracking::Quad* truth, double (*now_s)()) {
  const double begin = now_s();
  track_ = tracker_->track(frame);
  const double ms = 1e3 * (now_s() - begin);
  const bool lost = track_.state == TrackState::LOST;
  lost_ += lost;
  uncertain_ += track_.state == TrackState::UNCERTAIN;
  relocks_ += track_.reacquired;
  ms_.push_back(ms);
  double error = NAN;
  if (truth && !lost) {
    error = 0;
    for (std::size_t i = 0; i < 4; ++i) error += (track_.corners[i] - (*truth)[i]).norm() / 4;
    errors_px_.push_back(error);
    wrong_ok_ += track_.state == TrackState::OK && !(error <= kWrong_px);
  }
  scored_ = scored_ || truth;
  score_lost_ += lost || error > kWrong_px;
  std::vector<double> row{frame.time_s, static_cast<double>(frame.sequence), static_cast<double>(track_.state),
                          track_.quality};
  for (const auto& corner : track_.corners) row.insert(row.end(), {lost ? NAN : corner.x(), lost ? NAN : corner.y()});
  const Eigen::Vector2d moved = tracking::centre(track_.corners) - start_px_;
  row.insert(row.end(), {lost ? NAN : moved.x(), lost ? NAN : moved.y(), error, ms});
  if (!lost) {
    u_px_.push_back(moved.x());
    v_px_.push_back(moved.y());
  }
  if (estimator_) {
    const auto state = estimator_->estimate(track_);
    const bool known = state.state != TrackState::LOST;
    const Eigen::Vector3d p = state.T_camera_target.translation();
    const Eigen::Quaterniond q(state.T_camera_target.linear());
    for (const double v : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}) row.push_back(known ? v : NAN);
  }
  table_.append(row);
  return track_;
}

json TrackLane::summary() const {
  json j;
  j["name"] = name_;
  j["lost_frames"] = lost_;
  j["uncertain_frames"] = uncertain_;
  j["wrong_ok_frames"] = scored_ ? json(wrong_ok_) : json();
  j["score_lost_frames"] = scored_ ? json(score_lost_) : json();
  j["relocks"] = relocks_;
  j["error_px"] = nullptr;
  if (!errors_px_.empty()) {
    const auto e = servo::spread_of(errors_px_);
    j["error_px"] = {{"mean", e.mean}, {"std", e.std}, {"max", e.max}};
  }
  j["ms"] = {
      {"p50", servo::percentile(ms_, 50)}, {"p99", servo::percentile(ms_, 99)}, {"max", servo::percentile(ms_, 100)}};
  j["displacement_px"] = {{"x", extent(u_px_)}, {"y", extent(v_px_)}};
  return j;
}

std::string track_table(const json& summary) {
  std::string t =
      fmt::format("{}: {} frames\n\n{:<16}{:>6}{:>10}{:>11}{:>9}{:>11}{:>9}{:>9}{:>10}{:>10}{:>12}{:>12}\n",
                  summary["source"].get<std::string>(), summary["frames"].get<int>(), "tracker", "lost", "wrong OK",
                  "uncertain", "relocks", "error px", "std", "max", "ms p50", "ms p99", "x p-p px", "y p-p px");
  for (const json& lane : summary["trackers"]) {
    const json& e = lane["error_px"];
    const auto error = [&](const char* key) { return e.is_null() ? "-" : number(e[key], 3); };
    const auto swing = [&](const char* axis) {
      const json& d = lane["displacement_px"][axis];
      return d.is_null() ? "-" : number(d["peak_to_peak"], 1);
    };
    t +=
        fmt::format("{:<16}{:>6}{:>10}{:>11}{:>9}{:>11}{:>9}{:>9}{:>10}{:>10}{:>12}{:>12}\n",
                    lane["name"].get<std::string>(), lane["lost_frames"].get<int>(), number(lane["wrong_ok_frames"], 0),
                    lane["uncertain_frames"].get<int>(), lane["relocks"].get<int>(), error("mean"), error("std"),
                    error("max"), number(lane["ms"]["p50"], 3), number(lane["ms"]["p99"], 3), swing("x"), swing("y"));
  }
  return t;
}

}  // namespace heartservo::tools
