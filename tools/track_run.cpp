#include "tools/track_run.hpp"

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "servo/loop/score.hpp"
#include "tracking/frames/frame.hpp"

namespace heartservo::tools {

using nlohmann::json;
using tracking::TrackState;

namespace {

Eigen::Vector2d nowhere() { return Eigen::Vector2d::Constant(NAN); }

std::vector<std::string> column_names(const TruthKind& truth, bool metric, bool live) {
  std::vector<std::string> names{"time_s", "frame/sequence", "track/state", "track/quality"};
  const auto place = [&](const std::string& group) {
    for (const char* axis : {"/u_px", "/v_px"}) names.push_back(group + axis);
  };
  const auto corners = [&](const char* group) {
    for (int i = 0; i < 4; ++i) place(fmt::format("{}/corner{}", group, i));
  };
  corners("track");
  place("target");
  place("displacement");
  for (const char* name : {"error_px", "timing/track_ms"}) names.emplace_back(name);
  if (truth.corners) corners("truth");
  if (truth.point) {
    place("point");
    place("truth/point");
    names.emplace_back("point/error_px");
  }
  if (metric)
    for (const char* name :
         {"measured/x_m", "measured/y_m", "measured/z_m", "measured/sigma/z_m", "pose/qx", "pose/qy", "pose/qz", "pose/qw"})
      names.emplace_back(name);
  if (metric && truth.metric)
    for (const char* name : {"truth/x_m", "truth/y_m", "truth/z_m"}) names.emplace_back(name);
  if (live)
    for (const char* name : {"frame/age_s", "capture/device_sequence", "capture/skipped"}) names.emplace_back(name);
  return names;
}

json extent(const std::vector<double>& values) {
  const auto s = servo::spread_of(values);
  if (values.empty()) return nullptr;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {{"min", *low}, {"max", *high}, {"peak_to_peak", *high - *low}, {"rms", s.std}};
}

}  // namespace

TrackLane::TrackLane(std::string name, std::unique_ptr<tracking::TargetTracker> tracker,
                     std::unique_ptr<tracking::TargetEstimator> estimator, const TruthKind& truth, std::size_t frames,
                     const tracking::LiveSource* live)
    : name_(std::move(name)),
      tracker_(std::move(tracker)),
      estimator_(std::move(estimator)),
      live_(live),
      truth_(truth),
      table_(column_names(truth, estimator_ != nullptr, live != nullptr), frames),
      score_(truth) {}

std::string TrackLane::start(const tracking::Frame& frame, const TrackStart& start) {
  start_ = start;
  return tracker_->start(frame, start.region);
}

std::string TrackLane::restart(std::unique_ptr<tracking::TargetTracker> tracker,
                               std::unique_ptr<tracking::TargetEstimator> estimator, const tracking::Frame& frame,
                               const TrackStart& start) {
  if (frame.status != tracking::FrameStatus::OK) return "this frame shows nothing to learn";
  if (std::string why = tracker->start(frame, start.region); !why.empty()) return why;
  tracker_ = std::move(tracker);
  estimator_ = std::move(estimator);
  start_ = start;
  return "";
}

const tracking::Track& TrackLane::follow(const tracking::Frame& frame, const TrackTruth& truth, double (*now_s)()) {
  const double age = live_ ? live_->now_s() - frame.time_s : NAN, begin = now_s();
  track_ = tracker_->track(frame);
  const double ms = 1e3 * (now_s() - begin);
  const bool lost = track_.state == TrackState::LOST;
  point_ = truth_.point ? tracker_->carry(start_.point) : nowhere();
  errors_ = score_.add(track_, truth, point_);
  ms_.push_back(ms);

  row_.assign({frame.time_s, static_cast<double>(frame.sequence), static_cast<double>(track_.state), track_.quality});
  const auto put = [this](const Eigen::Vector2d& px) { row_.insert(row_.end(), {px.x(), px.y()}); };
  for (const auto& corner : track_.corners) put(lost ? nowhere() : corner);
  const Eigen::Vector2d moved = lost ? nowhere() : Eigen::Vector2d(track_.target - start_.centre);
  put(lost ? nowhere() : track_.target);
  put(moved);
  row_.insert(row_.end(), {errors_.corners_px, ms});
  if (truth_.corners)
    for (std::size_t i = 0; i < 4; ++i) put(truth.corners ? (*truth.corners)[i] : nowhere());
  if (truth_.point) {
    put(lost ? nowhere() : point_);
    put(truth.point);
    row_.push_back(errors_.point_px);
  }
  if (!lost) {
    u_px_.push_back(moved.x());
    v_px_.push_back(moved.y());
  }
  if (estimator_) measure(frame, truth);
  if (live_)
    row_.insert(row_.end(), {age, frame.capture ? static_cast<double>(frame.capture->device_sequence) : NAN,
                             frame.capture ? static_cast<double>(frame.capture->skipped) : NAN});
  table_.append(row_);
  return track_;
}

void TrackLane::measure(const tracking::Frame& frame, const TrackTruth& truth) {
  estimator_->look_at(frame);
  state_ = estimator_->estimate(track_);
  const auto& state = state_;
  const bool known = state.state != TrackState::LOST;
  const Eigen::Vector3d p = state.T_camera_target.translation();
  const Eigen::Quaterniond q(state.T_camera_target.linear());
  const double variance = state.position_covariance(2, 2) + state.lasting_covariance(2, 2);
  for (const double v : {p.x(), p.y(), p.z(), std::sqrt(variance), q.x(), q.y(), q.z(), q.w()})
    row_.push_back(known ? v : NAN);
  if (!truth_.metric) return;
  row_.insert(row_.end(), {truth.position.x(), truth.position.y(), truth.position.z()});
  if (!known || !truth.position.allFinite()) return;
  for (int axis = 0; axis < 3; ++axis) errors_m_[static_cast<std::size_t>(axis)].push_back((p - truth.position)[axis]);
  normalised_ += std::pow((p - truth.position).z(), 2) / variance;
}

json TrackLane::summary() const {
  json j = score_.summary();
  j["name"] = name_;
  j["ms"] = {
      {"p50", servo::percentile(ms_, 50)}, {"p99", servo::percentile(ms_, 99)}, {"max", servo::percentile(ms_, 100)}};
  if (start_.number > 0) j["region"] = start_.number;
  if (!errors_m_[0].empty())
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto e = servo::spread_of(errors_m_[axis]);
      j["position_error_mm"][std::string(1, "xyz"[axis])] = {
          {"rms", 1e3 * e.rms}, {"mean", 1e3 * e.mean}, {"std", 1e3 * e.std}, {"max", 1e3 * e.max}};
    }
  if (!errors_m_[0].empty())
    j["position_error_mm"]["normalised_z"] = normalised_ / static_cast<double>(errors_m_[0].size());
  j["displacement_px"] = {{"x", extent(u_px_)}, {"y", extent(v_px_)}};
  return j;
}

void follow_all(const tracking::Frame& frame, const std::vector<TrackTruth>& truths, bool threaded, double (*now_s)(),
                std::vector<TrackLane>& lanes) {
  const std::size_t regions = truths.size(), of_region = lanes.size() / regions;
  const auto follow_region = [&](std::size_t region) {
    for (std::size_t i = region * of_region; i < (region + 1) * of_region; ++i)
      lanes[i].follow(frame, truths[region], now_s);
  };
  if (regions > 1 && threaded)
    tbb::parallel_for(std::size_t{0}, regions, follow_region);
  else
    for (std::size_t region = 0; region < regions; ++region) follow_region(region);
}

}  // namespace heartservo::tools
