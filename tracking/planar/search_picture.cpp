#include "tracking/planar/search_picture.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "tracking/planar/patch.hpp"

namespace heartservo::tracking {

void SearchPicture::build(const cv::Mat& grey, const cv::Rect& window, int levels) {
  pyramid_.build(grey, window, levels);
  const PyramidLevel& finest = pyramid_.level(0);
  has_glare_ = false;
  for (int v = 0; v < finest.rows() && !has_glare_; ++v) {
    const std::uint8_t* row = finest.bytes.ptr(v);
    std::uint8_t brightest = 0;
    for (int u = 0; u < finest.cols(); ++u) brightest = std::max(brightest, row[u]);
    has_glare_ = static_cast<float>(brightest) >= kSaturatedGrey;
  }
  if (!has_glare_) return;
  glare_.resize(static_cast<std::size_t>(levels));
  const auto dilate = [this](const cv::Mat& from, int side) {
    cv::dilate(from, spread_, cv::Mat::ones(side, side, CV_8UC1), {-1, -1}, 1, cv::BORDER_REPLICATE);
  };
  for (int l = 0; l < levels; ++l) {
    PyramidLevel& level = glare_[static_cast<std::size_t>(l)];
    level.u0 = pyramid_.level(l).u0, level.v0 = pyramid_.level(l).v0, level.scale = pyramid_.level(l).scale;
    level.image.create(pyramid_.level(l).rows(), pyramid_.level(l).cols(), CV_32FC1);
    if (l == 0) {
      for (int v = 0; v < finest.rows(); ++v)
        for (int u = 0; u < finest.cols(); ++u)
          level.image.at<float>(v, u) = static_cast<float>(finest.bytes.at<std::uint8_t>(v, u)) >= kSaturatedGrey;
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
