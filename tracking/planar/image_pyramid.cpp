#include "tracking/planar/image_pyramid.hpp"

#include <opencv2/imgproc.hpp>

namespace heartservo::tracking {

void ImagePyramid::build(const cv::Mat& grey, const cv::Rect& window, int levels) {
  const int step = 1 << (levels - 1);
  const cv::Rect picture(0, 0, grey.cols, grey.rows);
  cv::Rect w = window & picture;
  if (w.empty()) w = picture;
  const int right = w.x + w.width, bottom = w.y + w.height;
  w.x = w.x / step * step;
  w.y = w.y / step * step;
  w.width = std::min((right - w.x + step - 1) / step * step, grey.cols - w.x);
  w.height = std::min((bottom - w.y + step - 1) / step * step, grey.rows - w.y);

  levels_.resize(std::max(levels_.size(), static_cast<std::size_t>(levels)));
  count_ = levels;
  grey(w).convertTo(levels_[0].image, CV_32F);
  for (int i = 0; i < levels; ++i) {
    PyramidLevel& level = levels_[static_cast<std::size_t>(i)];
    level.scale = 1.0F / static_cast<float>(1 << i);
    level.u0 = static_cast<float>(w.x) * level.scale;
    level.v0 = static_cast<float>(w.y) * level.scale;
    if (i > 0) cv::pyrDown(levels_[static_cast<std::size_t>(i) - 1].image, level.image);
  }
}

}  // namespace heartservo::tracking
