#pragma once
// Pose of the square with the least reprojection error through the distorted camera. Four coplanar points have two such
// minima, tilted about equally to either side of the line of sight; which one is real shows in the error when the tilt
// is large against the corner noise, and in the motion so far (side_filter.hpp) when it is not.
#include <Eigen/Geometry>
#include <array>

#include "tracking/camera/camera.hpp"
#include "tracking/landmark/reprojection.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::tracking {

struct RefinedPoseOptions {
  double corner_sigma_px = 0.05;  ///< standard deviation of a corner in u and in v
};

struct PoseSolution {
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();  ///< m
  double rms_px = 0;  ///< root mean square distance of the corners; NaN when there is no pose
  double chi2 = 0;    ///< SSE / max(sigma^2, SSE_min / 2); infinite when there is no pose
};

struct RefinedPose {
  std::array<PoseSolution, 2> solutions;  ///< both minima; where there is only one, IPPE's other solution
  int taken = -1;                         ///< index into `solutions`; -1: no pose from these corners
  double preference = 0;  ///< cost of the other solution minus that of the taken one (half is a log odds)
  /// Of the twist (v in m, w in rad; camera frame) of the taken one. First order: below about 5 degrees of tilt, where
  /// the two minima meet, the true position errors are up to 15 % larger (0.1 px) and the depth is short by half a
  /// sigma.
  Matrix6d covariance = Matrix6d::Zero();
};

/// `corners` in px, clockwise from top left, in the picture as taken. Takes the solution with the lower reprojection
/// error. chi2 has SSE_min / 2 (variance of the corners as the better fit shows it, 8 numbers less 6 unknowns) where
/// that is above sigma^2: a residual far above the stated sigma means that the sigma is wrong, not that a solution is
/// certain.
RefinedPose refined_square_pose(const Camera& camera, const Quad& corners, double side_m,
                                const RefinedPoseOptions& options = {});

}  // namespace heartservo::tracking
