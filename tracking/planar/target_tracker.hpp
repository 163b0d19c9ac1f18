#pragma once
#include <memory>
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
};

}  // namespace heartservo::tracking
