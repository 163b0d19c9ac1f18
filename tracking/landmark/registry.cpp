#include "tracking/landmark/registry.hpp"

#include "tracking/depth/region_depth_estimator.hpp"
#include "tracking/depth/stereo_depth_estimator.hpp"
#include "tracking/landmark/assumed_depth_estimator.hpp"
#include "tracking/landmark/landmark_estimator.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

auto landmark(const char* method) {
  return [method](const EstimatorOptions& options) -> std::unique_ptr<TargetEstimator> {
    return std::make_unique<LandmarkEstimator>(options.camera, options.side_m, method, options.corner_sigma_px);
  };
}

std::unique_ptr<TargetEstimator> assumed_depth(const EstimatorOptions& options) {
  return std::make_unique<AssumedDepthEstimator>(options.camera, options.depth_m, options.corner_sigma_px);
}

std::unique_ptr<TargetEstimator> region_depth(const EstimatorOptions& options) {
  return std::make_unique<RegionDepthEstimator>(options.camera, options.scale, options.depth, options.corner_sigma_px);
}

std::unique_ptr<TargetEstimator> stereo_depth(const EstimatorOptions& options) {
  if (!options.stereo)
    throw ConfigError("stereo_depth needs the second view of a stereo endoscope and its calibration");
  return std::make_unique<StereoDepthEstimator>(*options.stereo, options.matching, options.corner_sigma_px);
}

}  // namespace

const Registry<TargetEstimator, const EstimatorOptions&>& estimators() {
  static const Registry<TargetEstimator, const EstimatorOptions&> registry(
      "target estimator",
      {{"landmark_refined", "square landmark: least reprojection error, ambiguity resolved by motion",
        landmark("refined")},
       {"landmark_linear", "square landmark: pose read off the homography, eq. 6-8 as printed", landmark("linear")},
       {"landmark_visp", "square landmark: ViSP's virtual visual servoing", landmark("visp")},
       {"assumed_depth", "region of unknown size at a constant, assumed depth", assumed_depth},
       {"region_depth", "region whose distance is known once, then followed by its size and brightness", region_depth},
       {"stereo_depth", "region matched in the second view of a stereo endoscope, in every frame", stereo_depth}});
  return registry;
}

}  // namespace heartservo::tracking
