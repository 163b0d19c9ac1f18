#pragma once
// Starting values: homographies between a plane and its picture, the focal length and the poses that they imply.
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "tracking/camera/calibration/board.hpp"
#include "tracking/camera/camera.hpp"

namespace heartservo::tracking {

/// H_picture_plane by least squares from points of the plane z = 0 (m) and their images; nothing when they do not
/// determine one (all on a line, too few).
std::optional<Eigen::Matrix3d> plane_homography(const std::vector<Eigen::Vector3d>& points, const Corners& images);

/// Focal length (px) from homographies of several views, for a principal point in the middle of the picture and square
/// pixels: Zhang, "A flexible new technique for camera calibration" (2000), eq. 3 and 4. Nothing when the views have no
/// perspective that shows it.
std::optional<double> focal_length(const std::vector<Eigen::Matrix3d>& H_picture_plane, int width, int height);

/// Pose of the plane from its points as the camera sees them (px), eq. 6-8; nothing when there is none before the
/// camera.
std::optional<Eigen::Isometry3d> plane_pose(const Camera& camera, const std::vector<Eigen::Vector3d>& points,
                                            const Corners& images);

}  // namespace heartservo::tracking
