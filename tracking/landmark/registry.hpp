#pragma once
#include <optional>

#include "tracking/camera/camera.hpp"
#include "tracking/depth/depth_options.hpp"
#include "tracking/depth/scale_source.hpp"
#include "tracking/landmark/target_estimator.hpp"
#include "tracking/settings/registry.hpp"

namespace heartservo::tracking {

struct EstimatorOptions {
  Camera camera;
  double side_m = 0.005;          ///< side of the landmark; for landmark_*
  double depth_m = 0.055;         ///< for assumed_depth
  double corner_sigma_px = 0.05;  ///< standard deviation of a tracked corner in u and in v
  ScaleSource scale;              ///< for region_depth
  DepthOptions depth;             ///< for region_depth
  std::optional<StereoCamera> stereo;  ///< for stereo_depth
  StereoOptions matching;         ///< for stereo_depth
};

/// landmark_refined, landmark_linear, landmark_visp, assumed_depth, region_depth, stereo_depth.
const Registry<TargetEstimator, const EstimatorOptions&>& estimators();

}  // namespace heartservo::tracking
