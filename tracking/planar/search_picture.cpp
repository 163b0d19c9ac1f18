#include "tracking/planar/search_picture.hpp"

#include <opencv2/imgproc.hpp>

#include "tracking/planar/patch.hpp"

namespace heartservo::tracking {

void SearchPicture::build(const cv::Mat& grey, const cv::Rect& window, int levels) {
  pyramid_.build(grey, window, levels);
  const PyramidLevel& finest = pyramid_.level(0);
  double brightest = 0;
  cv::minMaxIdx(finest.image, nullptr, &brightest);
  has_glare_ = brightest >= static_cast<double>(kSaturatedGrey);
  if (!has_glare_) return;
  glare_.resize(static_cast<std::size_t>(levels));
  const auto dilate = [this](const cv::Mat& from, int side) {
    cv::dilate(from, spread_, cv::Mat::ones(side, side, CV_8UC1), {-1, -1}, 1, cv::BORDER_REPLICATE);
  };
  for (int l = 0; l < levels; ++l) {
    PyramidLevel& level = glare_[static_cast<std::size_t>(l)];
    level.u0 = pyramid_.level(l).u0, level.v0 = pyramid_.level(l).v0, level.scale = pyramid_.level(l).scale;
    level.image.create(pyramid_.level(l).image.size(), CV_32FC1);
    if (l == 0) {
      for (int v = 0; v < finest.image.rows; ++v)
        for (int u = 0; u < finest.image.cols; ++u)
          level.image.at<float>(v, u) = finest.image.at<float>(v, u) >= kSaturatedGrey ? 1.0F : 0.0F;
      dilate(level.image, 3);
      spread_.copyTo(level.image);
    } else {  // cv::pyrDown mixes 5 x 5 pixels
      dilate(glare_[static_cast<std::size_t>(l) - 1].image, 5);
      for (int v = 0; v < level.image.rows; ++v)
        for (int u = 0; u < level.image.cols; ++u) level.image.at<float>(v, u) = spread_.at<float>(2 * v, 2 * u);
    }
  }
}

}  // namespace heartservo::tracking
