#include "tools/track_view.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tools/window/selection.hpp"
#include "tracking/frames/frame.hpp"

namespace heartservo::tools {

namespace {

std::string state_line(const tracking::Frame& frame, const std::vector<TrackLane>& lanes) {
  std::string line = fmt::format("frame {}  {:.2f} s   ", frame.sequence, frame.time_s);
  for (const auto& lane : lanes)
    line += fmt::format("{} {} ({:.2f})   ", lane.name(), tracking::name_of(lane.track().state), lane.track().quality);
  return line;
}

std::string error_line(const TrackLane& lane) {
  const auto& errors = lane.errors();
  std::string line;
  if (std::isfinite(errors.corners_px)) line += fmt::format("residual {:.3f} px (corners)   ", errors.corners_px);
  if (std::isfinite(errors.point_px)) line += fmt::format("residual {:.3f} px (point)   ", errors.point_px);
  if (line.empty()) {
    const Eigen::Vector2d moved = lane.track().target - lane.began().centre;
    line = fmt::format("moved by {:.1f}, {:.1f} px   ", moved.x(), moved.y());
  }
  if (lane.state().state != tracking::TrackState::LOST)
    line += fmt::format("distance {:.2f} mm", 1e3 * lane.state().T_camera_target.translation().z());
  return line;
}

}  // namespace

TrackView::TrackView(bool show, int igtl_port, const std::string& source, tracking::FrameSource& frames)
    : live_(frames.live()) {
  if (igtl_port > 0) igtl_.emplace(igtl_port);
  if (show) window_.emplace("heartservo: " + source, frames.size(), !live_);
}

WindowView TrackView::view_of(const tracking::Frame& frame, const std::vector<TrackLane>& lanes) const {
  WindowView view;
  view.time_s = frame.time_s;
  view.picture = frame.colour.empty() ? frame.grey : frame.colour;
  double computing_ms = 0;
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    view.regions.push_back({lanes[i].track(), lanes.size() > 1 ? static_cast<int>(i) : -1});
    computing_ms += lanes[i].last_ms();
  }
  const auto& track = lanes.front().track();
  if (track.state != tracking::TrackState::LOST) view.tip_px = track.target;
  std::string latency = fmt::format("computing {:.2f} ms", computing_ms);
  if (live_)
    latency = fmt::format("latency {:.1f} ms since mid-exposure, ", 1e3 * (live_->now_s() - frame.time_s)) + latency;
  view.lines = {state_line(frame, lanes), error_line(lanes.front()), latency};
  return view;
}

bool TrackView::attend(const tracking::Frame& frame, const std::vector<TrackLane>& lanes, nlohmann::json& selections,
                       const LiveWindow::Stop& stop, const Relearn& relearn) {
  if (igtl_) {
    const auto& state = lanes.front().state();
    IgtlSnapshot snapshot;
    snapshot.time_s = frame.time_s;
    snapshot.has_tip = false;
    snapshot.has_target = state.state != tracking::TrackState::LOST;
    snapshot.T_camera_target = state.T_camera_target;
    snapshot.grey = frame.grey;
    igtl_->publish(snapshot);
  }
  if (!window_) return false;
  for (WindowView view = view_of(frame, lanes);;) {
    window_->show(view);
    const WindowState::Asked asked = window_->attend(stop);
    if (asked.quit || !(asked.relearn || asked.region)) return asked.quit;
    const tracking::Quad region = asked.region ? *asked.region : lanes.front().track().corners;
    if (const std::string why = relearn(region); !why.empty()) {
      view.lines.back() = "Not learnt: " + why;
      continue;
    }
    note_selection(selections, frame, region);
    for (auto& shown : view.regions) {
      if (lanes.size() > 1 && lanes[static_cast<std::size_t>(&shown - view.regions.data())].began().number > 1)
        continue;
      shown.track.corners = region;
      shown.track.state = tracking::TrackState::OK;
    }
  }
}

}  // namespace heartservo::tools
