#include "tracking/planar/image_pyramid.hpp"

#include <opencv2/imgproc.hpp>

namespace heartservo::tracking {

namespace {

constexpr int kHalo = 1;                     // px around glare that it brightens
constexpr double kSmallestClearShare = 0.4;  // of a pixel of a coarse level that must be free of glare

}  // namespace

void ImagePyramid::build(const cv::Mat& grey, const cv::Rect& window, int levels, double glare_grey) {
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
  }
  if (!halve_around_glare(grey(w), glare_grey))
    for (std::size_t i = 1; i < static_cast<std::size_t>(levels); ++i)
      cv::pyrDown(levels_[i - 1].image, levels_[i].image);
}

bool ImagePyramid::halve_around_glare(const cv::Mat& grey, double glare_grey) {
  cv::compare(grey, cv::Scalar(glare_grey), glare_, cv::CMP_GE);
  if (cv::countNonZero(glare_) == 0) return false;
  levels_[0].image.setTo(255, glare_);
  cv::dilate(glare_, glare_, cv::Mat(), cv::Point(-1, -1), kHalo);
  glare_.convertTo(clear_[0], CV_32F, -1.0 / 255, 1);
  cv::multiply(levels_[0].image, clear_[0], clear_grey_[0]);
  for (std::size_t i = 1; i < static_cast<std::size_t>(count_); ++i) {
    const std::size_t from = (i + 1) % 2, to = i % 2;  // two buffers in turn: pyrDown must not work in place
    cv::pyrDown(clear_[from], clear_[to]);
    cv::pyrDown(clear_grey_[from], clear_grey_[to]);
    cv::max(clear_[to], kSmallestClearShare / 2, share_);  // no division by 0
    cv::divide(clear_grey_[to], share_, levels_[i].image);
    cv::compare(clear_[to], cv::Scalar(kSmallestClearShare), glare_, cv::CMP_LT);
    levels_[i].image.setTo(255, glare_);
  }
  return true;
}

}  // namespace heartservo::tracking
