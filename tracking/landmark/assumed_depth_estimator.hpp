#pragma once
#include "tracking/camera/camera.hpp"
#include "tracking/landmark/target_estimator.hpp"

namespace heartservo::tracking {

/// For a region of unknown size: the centre of its corners on a plane at a constant, assumed depth Z0 before the
/// camera, position = Z0 (xn, yn, 1), rotation identity. Lateral motion is metric as far as Z0 is right; motion in
/// depth is not seen. The covariance is that of the corners; along z it is zero: Z0 is assumed, not measured.
class AssumedDepthEstimator final : public TargetEstimator {
 public:
  /// Throws ConfigError for a depth (m) or sigma (px) that is not positive.
  AssumedDepthEstimator(const Camera& camera, double depth_m, double corner_sigma_px = 0.05);

  TargetState estimate(const Track& track) override;

 private:
  Camera camera_;
  double depth_m_;
  double corner_sigma_px_;
};

}  // namespace heartservo::tracking
