#pragma once
// Where the tool goes while it does not follow the target. HOLD: back to where it was when the target was last seen.
// RETRACT: from there along its axis, away from the tissue. RESUME: from wherever it is to the moving goal, by an
// offset from the goal that fades away.
#include <Eigen/Core>
#include <algorithm>

#include "servo/safety/guard_options.hpp"
#include "servo/safety/loop_mode.hpp"

namespace heartservo::servo {

class Retreat {
 public:
  /// `axis`: from the tip along the shaft, away from the tissue; camera frame, any length.
  Retreat(const GuardOptions& options, const Eigen::Vector3d& axis)
      : options_(options), axis_(axis.stableNormalized()) {
    options_.retract_m = std::min(options_.retract_m, 0.5 * options_.workspace_radius_m);
  }

  /// The tip (m, camera frame) in a frame in which the target was followed by sight.
  void remember(const Eigen::Vector3d& tip) { safe_place_ = tip; }

  /// Velocity in HOLD and RETRACT, `mode_s` seconds after that mode began; `tip` is where the robot has been asked to
  /// be.
  Eigen::Vector3d velocity(LoopMode mode, double mode_s, const Eigen::Vector3d& tip) const;

  /// Begins an approach: the tip is `offset` away from the moving goal, at `time_s`.
  void approach(double time_s, const Eigen::Vector3d& offset);

  /// What is left of that offset at a time, and its rate.
  Eigen::Vector3d offset(double time_s) const;
  Eigen::Vector3d offset_rate(double time_s) const;
  bool arrived(double time_s) const { return time_s >= begin_s_ + duration_s_; }

 private:
  GuardOptions options_;
  Eigen::Vector3d axis_;
  Eigen::Vector3d safe_place_ = Eigen::Vector3d::Zero(), offset_ = Eigen::Vector3d::Zero();
  double begin_s_ = 0, duration_s_ = 0;
};

}  // namespace heartservo::servo
