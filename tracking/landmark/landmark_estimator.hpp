#pragma once
#include <string>

#include "tracking/camera/camera.hpp"
#include "tracking/landmark/refined_pose.hpp"
#include "tracking/landmark/side_filter.hpp"
#include "tracking/landmark/target_estimator.hpp"

namespace heartservo::tracking {

/// Metric pose of a square landmark from its four tracked corners (section 2.3). Target frame: square_pose.hpp.
/// LOST comes out where LOST goes in, or where the corners are no picture of the square (not convex, not finite, behind
/// the camera); UNCERTAIN passes through.
class LandmarkEstimator final : public TargetEstimator {
 public:
  /// `method`: "refined" (refined_pose.hpp), "linear" (eq. 6-8) or "visp" (visp_pose.hpp); anything else, or a side or
  /// sigma that is not positive, throws ConfigError. `corner_sigma_px`: standard deviation of a tracked corner in u and
  /// in v, which sets the covariance.
  LandmarkEstimator(const Camera& camera, double side_m, const std::string& method, double corner_sigma_px);

  TargetState estimate(const Track& track) override;

  /// Both poses and their errors of the last "refined" estimate; the one taken is that of the side filter.
  const RefinedPose& last_refined() const { return refined_; }

 private:
  enum class Method { REFINED, LINEAR, VISP };

  bool solve(const Track& track, TargetState& state);
  Eigen::Matrix3d linear_covariance(const Quad& corners) const;
  void choose_side(const Track& track);

  Camera camera_;
  double side_m_;
  Method method_;
  double corner_sigma_px_;
  RefinedPose refined_;
  SideFilter sides_;
};

}  // namespace heartservo::tracking
