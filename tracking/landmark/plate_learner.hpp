#pragma once
#include <opencv2/core/mat.hpp>

#include "tracking/camera/camera.hpp"
#include "tracking/landmark/dense_equations.hpp"

namespace heartservo::tracking {

/// What a plate looks like, for landmarks whose print is not at hand: the mean of its first pictures, each seen from
/// the pose it was found at and freed from its light.
class PlateLearner {
 public:
  explicit PlateLearner(const Camera& camera) : camera_(camera) {}

  static constexpr int kPictures = 32;

  bool done() const { return count_ >= kPictures; }

  /// The template with this picture in it; empty where the plate is not wholly in the picture.
  LandmarkTemplate learn(const cv::Mat& grey, double side_m, const Eigen::Isometry3d& T_camera_target,
                         const DenseLight& light);

 private:
  Camera camera_;
  cv::Mat mean_;
  int count_ = 0;
};

}  // namespace heartservo::tracking
