#include "tracking/planar/image_pyramid.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/planar/halve.hpp"
#include "tracking/planar/simd/copy_marked.hpp"

namespace heartservo::tracking {

cv::Mat PyramidLevel::floats() const {
  cv::Mat result = image;
  if (result.empty()) bytes.convertTo(result, CV_32F);
  return result;
}

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

  const auto count = static_cast<std::size_t>(levels);
  if (levels_.size() < count) levels_.resize(count), storage_.resize(count);
  count_ = levels;
  cv::Size size = w.size();
  for (std::size_t i = 0; i < count; ++i) {
    PyramidLevel& level = levels_[i];
    level.scale = 1.0F / static_cast<float>(1 << i);
    level.u0 = static_cast<float>(w.x) * level.scale;
    level.v0 = static_cast<float>(w.y) * level.scale;
    if (i == 0) continue;
    size = {(size.width + 1) / 2, (size.height + 1) / 2};
    std::vector<float>& storage = storage_[i];
    storage.resize(std::max(storage.size(), static_cast<std::size_t>(size.area())));
    level.image = cv::Mat(size, CV_32FC1, storage.data());
  }
  const bool glare = copy_window(grey(w), glare_grey);
  if (levels == 1) return;
  if (glare) clear_.start(levels_[0].bytes);
  for (std::size_t i = 1; i < count; ++i)
    if (glare)
      clear_.next(levels_[i].image);
    else
      halve(i == 1 ? levels_[0].bytes : levels_[i - 1].image, levels_[i].image, scratch_);
}

// Glare becomes 255. Returns whether there is any.
bool ImagePyramid::copy_window(const cv::Mat& window, double glare_grey) {
  constexpr int kBeyond = 8;
  const int stride = window.cols + 2 * kBeyond;
  const std::size_t size = static_cast<std::size_t>(stride) * static_cast<std::size_t>(window.rows + 2);
  if (bytes_.size() < size) bytes_.resize(size);
  levels_[0].bytes = cv::Mat(window.rows, window.cols, CV_8UC1, bytes_.data() + stride + kBeyond, stride);
  const int glare = static_cast<int>(std::ceil(std::clamp(glare_grey, 0.0, 256.0)));
  bool any = false;
  for (int row = 0; row < window.rows; ++row)
    any |= simd::copy_marked(window.ptr(row), static_cast<std::size_t>(window.cols), glare, levels_[0].bytes.ptr(row));
  return any;
}

}  // namespace heartservo::tracking
