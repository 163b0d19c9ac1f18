#pragma once
#include <Eigen/Geometry>

#include "tracking/camera/camera.hpp"

namespace heartservo::tracking {

/// How far the centre of gravity of a disc's picture is from the picture of its centre (px): perspective and the lens
/// enlarge its near side. The disc lies in the board's plane at `centre` (m).
Eigen::Vector2d disc_offset(const Camera& camera, const Eigen::Isometry3d& T_camera_board,
                            const Eigen::Vector3d& centre, double diameter_m);

}  // namespace heartservo::tracking
