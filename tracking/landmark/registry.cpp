#include "tracking/landmark/registry.hpp"

#include "tracking/landmark/assumed_depth_estimator.hpp"
#include "tracking/landmark/dense_estimator.hpp"
#include "tracking/landmark/landmark_estimator.hpp"

namespace heartservo::tracking {

namespace {

auto landmark(const char* method) {
  return [method](const EstimatorOptions& options) -> std::unique_ptr<TargetEstimator> {
    return std::make_unique<LandmarkEstimator>(options.camera, options.side_m, method, options.corner_sigma_px);
  };
}

std::unique_ptr<TargetEstimator> dense(const EstimatorOptions& options) {
  return std::make_unique<DenseEstimator>(options.camera, options.side_m, options.plate, options.corner_sigma_px);
}

std::unique_ptr<TargetEstimator> assumed_depth(const EstimatorOptions& options) {
  return std::make_unique<AssumedDepthEstimator>(options.camera, options.depth_m, options.corner_sigma_px);
}

}  // namespace

const Registry<TargetEstimator, const EstimatorOptions&>& estimators() {
  static const Registry<TargetEstimator, const EstimatorOptions&> registry(
      "target estimator",
      {{"landmark_refined", "square landmark: least reprojection error, ambiguity resolved by motion",
        landmark("refined")},
       {"landmark_dense", "square landmark: pose from all its grey levels, ambiguity resolved by motion", dense},
       {"landmark_linear", "square landmark: pose read off the homography, eq. 6-8 as printed", landmark("linear")},
       {"landmark_visp", "square landmark: ViSP's virtual visual servoing", landmark("visp")},
       {"assumed_depth", "region of unknown size at a constant, assumed depth", assumed_depth}});
  return registry;
}

}  // namespace heartservo::tracking
