#pragma once
// Reprojection of the square through the distorted camera, and the pose that makes its error least.
#include <Eigen/Geometry>

#include "tracking/camera/camera.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::tracking {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Jacobian8x6 = Eigen::Matrix<double, 8, 6>;

/// The corners (px, clockwise from top left) of a square at T_camera_target, eq. 1-4.
Quad project_square(const Camera& camera, const Eigen::Isometry3d& T_camera_target, double side_m);

/// T moved by the small twist (v, w): t + v and exp(w) R, both in the camera frame.
Eigen::Isometry3d moved(const Eigen::Isometry3d& T, const Eigen::Matrix<double, 6, 1>& twist);

/// d corners (u0, v0, u1, ...; px) / d twist (v in m, w in rad) of moved(), at 0.
Jacobian8x6 square_jacobian(const Camera& camera, const Eigen::Isometry3d& T_camera_target, double side_m);

/// Root mean square over the corners of their distance (px) to where `corners` says they are. NaN behind the camera.
double reprojection_rms_px(const Camera& camera, const Eigen::Isometry3d& T_camera_target, double side_m,
                           const Quad& corners);

/// Levenberg-Marquardt from `start` to the nearest minimum of the reprojection error.
Eigen::Isometry3d refine_pose(const Camera& camera, const Eigen::Isometry3d& start, double side_m, const Quad& corners);

/// (J^T J)^-1 sigma^2: covariance of the twist (v, w) of a refined pose, for corners with independent errors of
/// standard deviation `corner_sigma_px` in u and v.
Matrix6d pose_covariance(const Camera& camera, const Eigen::Isometry3d& T_camera_target, double side_m,
                         double corner_sigma_px);

}  // namespace heartservo::tracking
