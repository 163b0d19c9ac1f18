#pragma once
// The landmark: a planar square of known side. Target frame: origin at its centre, x right, y down, z away from the
// camera when it is seen from the front; corners clockwise from top left.
#include <Eigen/Geometry>
#include <array>

namespace heartservo::tracking {

/// Corner i of the square in the target frame (m; z = 0).
inline Eigen::Vector3d square_corner(int i, double side_m) {
  const double h = side_m / 2;
  return {i == 1 || i == 2 ? h : -h, i >= 2 ? h : -h, 0};
}

/// Eq. 6-8: T_camera_target from the four corners on the undistorted normalised plane: H from the corners,
/// s = (1/2 (|h1| + |h2|))^-1, r1 = s h1, r2 = s h2, r3 = r1 x r2, t = s h3; the rotation is then projected onto SO(3).
/// Not finite for corners of no area.
Eigen::Isometry3d linear_square_pose(const std::array<Eigen::Vector2d, 4>& normalised_corners, double side_m);

}  // namespace heartservo::tracking
