#pragma once
#include "tools/capture/window.hpp"
#include "tracking/planar/track.hpp"

namespace heartservo::tools {

/// The followed region as it is shown in the window: yellow while the tracker is sure, orange while it is not; a lost
/// one is not shown.
inline void add_outline(const tracking::Track& track, std::vector<Window::Outline>& outlines) {
  if (track.state == tracking::TrackState::LOST) return;
  Window::Outline outline{{}, cv::Scalar(0, track.state == tracking::TrackState::OK ? 220 : 140, 255)};
  for (const auto& corner : track.corners) outline.corners.emplace_back(corner.x(), corner.y());
  outlines.push_back(std::move(outline));
}

}  // namespace heartservo::tools
