#pragma once
#include <optional>

#include "tracking/depth/stereo_match.hpp"
#include "tracking/landmark/target_estimator.hpp"

namespace heartservo::tracking {

/// Metric pose of a region from both views of a stereo endoscope, in every frame anew. Target frame: origin at the
/// region's centre, x and y along its sides, z into the tissue. The state is no better than the match: LOST where the
/// right picture is missing, or the region is not found in it.
class StereoDepthEstimator final : public TargetEstimator {
 public:
  /// Throws ConfigError: the camera or the options do not validate, or a sigma (px) that is not positive.
  StereoDepthEstimator(const StereoCamera& camera, const StereoOptions& options, double corner_sigma_px);

  void look_at(const Frame& frame) override;
  TargetState estimate(const Track& track) override;

  const StereoMatch& last_match() const { return match_; }

 private:
  StereoMatcher matcher_;
  StereoOptions options_;
  double corner_sigma_px_;
  cv::Mat left_, right_;
  StereoMatch match_;
};

}  // namespace heartservo::tracking
