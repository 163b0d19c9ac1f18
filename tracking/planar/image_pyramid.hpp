#pragma once
#include <opencv2/core/mat.hpp>
#include <vector>

namespace heartservo::tracking {

/// One level: `image` (CV_32FC1) shows the picture's window whose first pixel is (u0, v0) of the *full* picture at this
/// level's scale; pixel (u, v) of the full picture is at (u / 2^level, v / 2^level).
struct PyramidLevel {
  cv::Mat image;
  float u0 = 0, v0 = 0;
  float scale = 1;  ///< 2^-level
};

/// Grey picture in float, halved again and again (Gaussian, cv::pyrDown), only inside a window of it.
class ImagePyramid {
 public:
  /// `window` is clipped to the picture and widened to multiples of 2^(levels-1). Memory is kept between calls.
  void build(const cv::Mat& grey, const cv::Rect& window, int levels);

  int levels() const { return count_; }
  const PyramidLevel& level(int i) const { return levels_[static_cast<std::size_t>(i)]; }

 private:
  std::vector<PyramidLevel> levels_;
  int count_ = 0;
};

}  // namespace heartservo::tracking
