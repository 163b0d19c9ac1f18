#pragma once
// Who looks on while `track` runs: the live window and OpenIGTLink clients.
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/igtl/igtl_stream.hpp"
#include "tools/track_run.hpp"
#include "tools/window/live_window.hpp"

namespace heartservo::tracking {
class FrameSource;
}

namespace heartservo::tools {

class TrackView {
 public:
  /// `igtl_port`: 0 for no clients. Throws DeviceError.
  TrackView(bool show, int igtl_port, const std::string& source, tracking::FrameSource& frames);

  /// Null without one.
  LiveWindow* window() { return window_ ? &*window_ : nullptr; }

  /// "" or the reason for which the region is refused.
  using Relearn = std::function<std::string(const tracking::Quad&)>;
  /// Hands the frame on and does what keys and mouse ask for; true: the run is to end. What was learnt anew is noted in
  /// `selections`.
  bool attend(const tracking::Frame& frame, const std::vector<TrackLane>& lanes, nlohmann::json& selections,
              const LiveWindow::Stop& stop, const Relearn& relearn);

 private:
  WindowView view_of(const tracking::Frame& frame, const std::vector<TrackLane>& lanes) const;

  const tracking::LiveSource* live_;
  std::optional<IgtlStream> igtl_;
  std::optional<LiveWindow> window_;
};

}  // namespace heartservo::tools
