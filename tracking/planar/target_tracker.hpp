#pragma once
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

#include "tracking/planar/track.hpp"

namespace heartservo::tracking {

struct Frame;

/// Follows one region of the picture.
class TargetTracker {
 public:
  virtual ~TargetTracker() = default;

  /// Learns the region from a frame. Returns "" or the reason for which the region cannot be tracked (outside the
  /// picture, too small, without texture).
  virtual std::string start(const Frame& frame, const Quad& corners) = 0;

  /// Follows the region into the next frame. Never throws for a bad picture: the state says LOST.
  virtual Track track(const Frame& frame) = 0;

  /// Where a point of the region (px, in the frame it was learnt from) lies in the frame last tracked, under this
  /// tracker's model of how the region changes its shape; while LOST, where it was last believed to be.
  virtual Eigen::Vector2d carry(const Eigen::Vector2d& start_px) const = 0;

  /// What the last frame's result does not rest on: sets `mask` (CV_8UC1, as large as the picture, made where it is
  /// empty) to 255 at pixels of the region taken for glare, a tool or other strange things. Call it before the frame's
  /// pixels go away. Leaves the other pixels alone, so that several trackers can share a mask. For people to look at:
  /// not meant for every frame of a fast loop.
  virtual void mark_left_out(cv::Mat& mask) = 0;
};

}  // namespace heartservo::tracking
