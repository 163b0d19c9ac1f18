#pragma once
// Pose of the landmark straight from its grey levels: the six parameters of the pose and those of the light that leave
// the least squared grey difference over every pixel of the plate, through the distorted camera. Where corners sum up
// the picture in eight numbers and a homography spends eight on what only has six, this one spends nothing: with white
// grey noise of standard deviation sigma its covariance is the Cramer-Rao bound.
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "tracking/landmark/dense_equations.hpp"
#include "tracking/landmark/ray_map.hpp"
#include "tracking/landmark/reprojection.hpp"
#include "tracking/landmark/simd/dense_kernel.hpp"
#include "tracking/planar/simd/aligned.hpp"

namespace heartservo::tracking {

struct DenseOptions {
  int max_iterations = 30;
  double outlier_sigmas = 3;     ///< a pixel further off counts less, at twice as much nothing (tool, glare, blood)
  double saturated_grey = 250;   ///< from here on a pixel is left out: it is clipped
  double smallest_share = 0.4;   ///< of the plate's pixels that must count
  int smallest_pixels = 200;     ///< that must count
  double smallest_likeness = 0.3;  ///< share of the pixels' variance that template and light must explain
  double largest_move_px = 4;    ///< of a corner from the start; further away is another minimum

  /// Every problem at once, empty when usable.
  std::vector<std::string> validate() const;
};

struct DensePose {
  bool valid = false;  ///< false: too few pixels, no convergence, or far from the start; nothing below holds
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist (v in m, w in rad; camera frame)
  DenseLight light = DenseLight::Zero();
  double rms_grey = 0;  ///< of the grey differences of the pixels that count
  double share = 0;     ///< of the plate's pixels that count
  double pixels = 0;    ///< that count, by their weights
  double likeness = 0;  ///< share of these pixels' variance that template and light explain
  int iterations = 0;
};

/// Gauss-Newton on the grey levels. Keeps its workspace: nothing is allocated once a landmark of this size was seen.
class DenseRefiner {
 public:
  /// Throws ConfigError for options that do not validate.
  explicit DenseRefiner(const Camera& camera, const DenseOptions& options = {});

  /// `grey`: CV_8UC1 of the camera's size. `start`: right to within the pattern's finest cells, about 2 px.
  DensePose refine(const cv::Mat& grey, const LandmarkTemplate& plate, double side_m, const Eigen::Isometry3d& start);

 private:
  using Normal = Eigen::Matrix<double, simd::kDenseRow, simd::kDenseRow, Eigen::RowMajor>;  // of (row, residual)

  simd::DensePixels pixels();
  void collect(const cv::Mat& grey, const LandmarkTemplate& plate, double side_m, const Eigen::Isometry3d& T);
  bool first_light(const LandmarkTemplate& plate, const PlateView& view, DenseLight& light);
  void weigh();
  double grey_variance() const;  // of the pixels that count
  Normal normal_equations(const LandmarkTemplate& plate, const PlateView& view, const DenseLight& light);

  Camera camera_;
  DenseOptions options_;
  RayMap rays_;
  std::size_t count_ = 0;  // of pixels
  simd::AlignedFloats ray_x_, ray_y_, grey_, residual_, weight_;
  simd::AlignedFloats sizes_;  // of residuals, to find their median
  std::size_t region_pixels_ = 0;
};

}  // namespace heartservo::tracking
