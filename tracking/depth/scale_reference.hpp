#pragma once
// Where metres come from when nothing in the picture has a known size: the distance of the region, known once.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "tracking/camera/camera.hpp"
#include "tracking/landmark/target_estimator.hpp"

namespace heartservo::tracking {

/// The region in the first frame. However it was found (told, a tool that touched the tissue, a landmark seen there
/// once, the first stereo frame), this is all that is kept of it.
struct ScaleReference {
  double depth_m = 0;  ///< z of the region's centre, camera frame
  double sigma_m = 0;  ///< its standard deviation
  /// Slopes dz/dx, dz/dy of the region's plane, and their standard deviation. Without knowledge a region that looks at
  /// the camera is as good a guess as any.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double slope_sigma = 0.2;

  /// Every problem at once; empty when usable.
  std::vector<std::string> validate() const;
};

/// The distance at which the ray through `centre_px` (the region's) meets the plane of a landmark that lies beside or
/// on the region: `landmark` is its pose in that frame, with the twist's covariance (v in m, w in rad; camera frame).
/// `roughness_m`: how far the tissue is from the landmark's plane there. validate() refuses the result where the ray
/// misses the plane, or the landmark was LOST.
ScaleReference scale_from_landmark(const Camera& camera, const TargetState& landmark,
                                   const Eigen::Matrix<double, 6, 6>& twist_covariance,
                                   const Eigen::Vector2d& centre_px, double roughness_m = 2e-4);

}  // namespace heartservo::tracking
