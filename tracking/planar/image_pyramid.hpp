#pragma once
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "tracking/planar/clear_means.hpp"

namespace heartservo::tracking {

/// One level: shows the picture's window whose first pixel is (u0, v0) of the *full* picture at this level's scale;
/// pixel (u, v) of the full picture is at (u / 2^level, v / 2^level).
struct PyramidLevel {
  cv::Mat image;  ///< CV_32FC1, of level 1 and up
  cv::Mat bytes;  ///< CV_8UC1, of level 0; readable one row and four pixels beyond its borders
  float u0 = 0, v0 = 0;
  float scale = 1;  ///< 2^-level

  int cols() const { return bytes.empty() ? image.cols : bytes.cols; }
  int rows() const { return bytes.empty() ? image.rows : bytes.rows; }
  /// CV_32FC1, a copy on level 0.
  cv::Mat floats() const;
};

/// Grey values from this on are glare or clipping and say nothing about the tissue.
inline constexpr float kSaturatedGrey = 240;

/// Grey picture, in float halved again and again (Gaussian, halve.hpp), only inside a window of it. Glare is not
/// smeared into the coarse levels (clear_means.hpp).
class ImagePyramid {
 public:
  ImagePyramid() = default;
  ImagePyramid(ImagePyramid&&) = default;  // no copies: levels point into their storage
  ImagePyramid& operator=(ImagePyramid&&) = default;

  /// `window` is clipped to the picture and widened to multiples of 2^(levels-1). Memory is kept between calls.
  void build(const cv::Mat& grey, const cv::Rect& window, int levels, double glare_grey = kSaturatedGrey);

  int levels() const { return count_; }
  const PyramidLevel& level(int i) const { return levels_[static_cast<std::size_t>(i)]; }

 private:
  bool copy_window(const cv::Mat& window, double glare_grey);

  std::vector<PyramidLevel> levels_;
  std::vector<std::uint8_t> bytes_;          // of level 0
  std::vector<std::vector<float>> storage_;  // of each level's image: grows, never shrinks
  std::vector<float> scratch_;
  ClearMeans clear_;
  int count_ = 0;
};

}  // namespace heartservo::tracking
