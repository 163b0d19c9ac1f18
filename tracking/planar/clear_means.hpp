#pragma once
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace heartservo::tracking {

/// Coarse levels of a picture with glare, which is not smeared into them: their pixels are means over what is clear
/// (normalised convolution, Knutsson & Westin, CVPR 1993), and 255 where little is. Memory is kept between pictures.
class ClearMeans {
 public:
  /// Level 0: CV_8UC1 in which 255 is glare.
  void start(const cv::Mat& bytes);

  /// The level after the last one, half its size (halve.hpp): CV_32FC1 of that size.
  void next(cv::Mat& image);

 private:
  struct Pair {
    std::vector<float> share, grey;  // of a pixel that is clear; the grey level times it
  };
  Pair levels_[2];
  std::vector<float> scratch_;
  std::vector<std::uint8_t> glare_, glare_scratch_;
  cv::Size size_;  // of the last level
  int last_ = 0;   // which of the two it is in
};

}  // namespace heartservo::tracking
