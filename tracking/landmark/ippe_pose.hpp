#pragma once
#include <Eigen/Geometry>
#include <array>

namespace heartservo::tracking {

/// Both poses T_camera_target that a square can have for its four corners (undistorted normalised plane, clockwise from
/// top left), the better-fitting one first: Collins & Bartoli, "Infinitesimal plane-based pose estimation" (IJCV 2014),
/// what cv::SOLVEPNP_IPPE_SQUARE does, without memory from the heap. Returns false where there is none.
bool ippe_square_poses(const std::array<Eigen::Vector2d, 4>& normalised_corners, double side_m,
                       std::array<Eigen::Isometry3d, 2>& T_camera_target);

}  // namespace heartservo::tracking
