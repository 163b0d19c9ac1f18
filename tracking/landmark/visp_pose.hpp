#pragma once
#include <Eigen/Geometry>
#include <array>
#include <optional>

namespace heartservo::tracking {

/// ViSP's pose of the square from its corners on the undistorted normalised plane (vpCameraParameters cannot hold eq. 3
/// and 4): virtual visual servoing from Dementhon's and from Lagrange's start, the better of the two. Nothing where
/// ViSP finds none.
std::optional<Eigen::Isometry3d> visp_square_pose(const std::array<Eigen::Vector2d, 4>& normalised_corners,
                                                  double side_m);

}  // namespace heartservo::tracking
