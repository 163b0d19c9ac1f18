#pragma once
#include <opencv2/core/mat.hpp>

#include "tracking/landmark/dense_pose.hpp"
#include "tracking/landmark/landmark_estimator.hpp"
#include "tracking/landmark/plate_learner.hpp"

namespace heartservo::tracking {

/// Metric pose of a square landmark from all its pixels (dense_pose.hpp), started at the pose from its tracked corners.
/// Both sides of the planar ambiguity are tried unless the corners leave no doubt; grey levels and the frames before
/// decide (side_filter.hpp). Where the grey levels give no pose - no frame was shown, the plate is mostly covered or
/// looks like something else - the pose is that of the corners, with their covariance.
class DenseEstimator final : public TargetEstimator {
 public:
  /// `plate`: picture of the landmark as printed, CV_8UC1, square, 64 px or more, outline to outline. Empty: it is learnt
  /// from the first frames, at the pose that the corners of the first have; an error of that pose stays in all others.
  /// Throws ConfigError for another picture, or a side or sigma that is not positive.
  DenseEstimator(const Camera& camera, double side_m, const cv::Mat& plate, double corner_sigma_px,
                 const DenseOptions& options = {});

  void look_at(const Frame& frame) override;
  TargetState estimate(const Track& track) override;

  /// Of the last estimate; not valid where that is from the corners.
  const DensePose& last_dense() const { return dense_; }

 private:
  DensePose refine(const TargetState& state);
  DensePose better_side(const TargetState& state);

  Camera camera_;
  double side_m_;
  cv::Mat plate_, grey_;
  std::uint64_t sequence_ = 0;
  LandmarkEstimator corners_;
  DenseRefiner refiner_;
  SideFilter sides_;
  LandmarkTemplate template_;
  PlateLearner learner_;
  DensePose dense_;
  int blur_changes_ = 0;
  bool blur_found_ = false;
};

}  // namespace heartservo::tracking
