#include "tracking/planar/clear_means.hpp"

#include <algorithm>
#include <cstddef>

#include "tracking/planar/halve.hpp"
#include "tracking/planar/spread.hpp"
#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

namespace {

constexpr int kHalo = 1;                     // px around glare that it brightens
constexpr float kSmallestClearShare = 0.4F;  // of a pixel of a coarse level that must be free of glare

HEARTSERVO_SIMD void split(const std::uint8_t* __restrict bytes, const std::uint8_t* __restrict glare, int n,
                           float* __restrict share, float* __restrict grey) {
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    share[i] = glare[i] != 0 ? 0.0F : 1.0F;
    grey[i] = share[i] * static_cast<float>(bytes[i]);
  }
}

HEARTSERVO_SIMD void divide(const float* __restrict grey, const float* __restrict share, int n, float* __restrict to) {
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const float mean = grey[i] / std::max(share[i], kSmallestClearShare / 2);  // no division by 0
    to[i] = share[i] < kSmallestClearShare ? 255.0F : mean;
  }
}

void grow(std::vector<float>& values, cv::Size size) {
  values.resize(std::max(values.size(), static_cast<std::size_t>(size.area())));
}

}  // namespace

void ClearMeans::start(const cv::Mat& bytes) {
  size_ = bytes.size();
  last_ = 0;
  const auto cols = static_cast<std::size_t>(size_.width), pixels = static_cast<std::size_t>(size_.area());
  glare_.resize(std::max(glare_.size(), pixels));
  for (int v = 0; v < size_.height; ++v) {
    const std::uint8_t* from = bytes.ptr(v);
    std::uint8_t* to = glare_.data() + static_cast<std::size_t>(v) * cols;
    for (std::size_t u = 0; u < cols; ++u) to[u] = from[u] == 255 ? 255 : 0;
  }
  spread(glare_.data(), size_.width, size_.height, kHalo, glare_.data(), glare_scratch_);
  Pair& level = levels_[last_];
  grow(level.share, size_), grow(level.grey, size_);
  for (int v = 0; v < size_.height; ++v) {
    const std::size_t row = static_cast<std::size_t>(v) * cols;
    split(bytes.ptr(v), glare_.data() + row, size_.width, level.share.data() + row, level.grey.data() + row);
  }
}

void ClearMeans::next(cv::Mat& image) {
  Pair &from = levels_[last_], &to = levels_[1 - last_];
  const cv::Size size = image.size();
  grow(to.share, size), grow(to.grey, size);
  cv::Mat share(size, CV_32FC1, to.share.data()), grey(size, CV_32FC1, to.grey.data());
  halve(cv::Mat(size_, CV_32FC1, from.share.data()), share, scratch_);
  halve(cv::Mat(size_, CV_32FC1, from.grey.data()), grey, scratch_);
  for (int v = 0; v < size.height; ++v)
    divide(grey.ptr<float>(v), share.ptr<float>(v), size.width, image.ptr<float>(v));
  size_ = size;
  last_ = 1 - last_;
}

}  // namespace heartservo::tracking
