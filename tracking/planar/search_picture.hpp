#pragma once
#include <cstdint>
#include <vector>

#include "tracking/planar/image_pyramid.hpp"

namespace heartservo::tracking {

/// The part of a picture in which candidates are looked for: grey values at several scales, and where glare is.
class SearchPicture {
 public:
  /// `grey` CV_8UC1; `window` as of ImagePyramid::build.
  void build(const cv::Mat& grey, const cv::Rect& window, int levels);

  const ImagePyramid& pyramid() const { return pyramid_; }
  bool has_glare() const { return has_glare_; }
  /// 1 at pixels that are saturated or take grey from a saturated one, else 0. Only where has_glare().
  const PyramidLevel& glare(int level) const { return glare_[static_cast<std::size_t>(level)]; }

 private:
  ImagePyramid pyramid_;
  std::vector<PyramidLevel> glare_;
  std::vector<std::uint8_t> mask_, scratch_;
  std::vector<std::vector<float>> values_;  // of each level's glare: grows, never shrinks
  bool has_glare_ = false;
};

}  // namespace heartservo::tracking
