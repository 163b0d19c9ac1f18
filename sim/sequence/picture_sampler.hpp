#pragma once
// A picture seen through a homography, exact to a ten-thousandth of a pixel: cv::warpPerspective rounds positions to
// 1/32 px, which would spoil the truth of a sequence. Each pixel is the mean of 2 x 2 Catmull-Rom samples (the pixel's
// area), taken at positions computed in float from row starts in double.
#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace heartservo::sim {

class PictureSampler {
 public:
  /// `grey`: CV_32FC1, `texels_per_px` texels per pixel of the first frame; its middle lies at `middle_px` there.
  /// Beyond its border the picture is mirrored once, then goes on with its last texels.
  PictureSampler(const cv::Mat& grey, double texels_per_px, const Eigen::Vector2d& middle_px);

  /// Grey levels of the pixels u .. u + count - 1 of row v in a frame; `H_reference_current` takes the frame's pixels
  /// to those of the first frame.
  void row(const Eigen::Matrix3d& H_reference_current, int u, int v, int count, float* grey) const;

 private:
  static constexpr int kBorder = 3;  // texels
  cv::Mat padded_;
  int width_, height_;  // without the border
  Eigen::Matrix3d A_texel_reference_;
};

}  // namespace heartservo::sim
