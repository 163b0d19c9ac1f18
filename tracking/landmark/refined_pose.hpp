#pragma once
// Pose of the square with the least reprojection error through the distorted camera. Four coplanar points have two such
// minima, tilted about equally to either side of the line of sight; which one is real shows in the error when the tilt
// is large against the corner noise, and in the motion so far when it is not.
#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "tracking/camera/camera.hpp"
#include "tracking/landmark/reprojection.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::tracking {

struct RefinedPoseOptions {
  double corner_sigma_px = 0.05;           ///< standard deviation of a corner in u and in v
  double predicted_angle_sigma = 0.15;     ///< rad; how far the rotation may be from the predicted one
  double predicted_position_sigma = 2e-3;  ///< m
};

struct PoseSolution {
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();  ///< m
  double rms_px = 0;  ///< root mean square distance of the corners; NaN when there is no pose
};

struct RefinedPose {
  std::array<PoseSolution, 2> solutions;  ///< both minima; the same one twice where there is only one
  int taken = -1;                         ///< index into `solutions`; -1: no pose from these corners
  double preference = 0;  ///< cost of the other solution minus that of the taken one (half is a log odds)
  /// Of the twist (v in m, w in rad; camera frame) of the taken one. First order: below about 5 degrees of tilt, where
  /// the two minima meet, the true position errors are up to 15 % larger (0.1 px) and the depth is short by half a
  /// sigma.
  Matrix6d covariance = Matrix6d::Zero();
};

/// `corners` in px, clockwise from top left, in the picture as taken. Without a prediction the solution with the lower
/// reprojection error is taken; with one, the cost
///   SSE / max(sigma^2, SSE_min / 2) + (angle to predicted / sigma_angle)^2 + (distance to predicted /
///   sigma_position)^2
/// decides (SSE_min / 2: variance of the corners as the better fit shows it, 8 numbers less 6 unknowns).
RefinedPose refined_square_pose(const Camera& camera, const Quad& corners, double side_m,
                                const RefinedPoseOptions& options = {},
                                const std::optional<Eigen::Isometry3d>& predicted = std::nullopt);

}  // namespace heartservo::tracking
