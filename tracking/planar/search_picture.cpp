#include "tracking/planar/search_picture.hpp"

#include <algorithm>

#include "tracking/planar/spread.hpp"

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
  for (int l = 0; l < levels; ++l) {
    const PyramidLevel& of = pyramid_.level(l);
    PyramidLevel& level = glare_[static_cast<std::size_t>(l)];
    level.u0 = of.u0, level.v0 = of.v0, level.scale = of.scale;
    const auto cols = static_cast<std::size_t>(of.cols()), size = cols * static_cast<std::size_t>(of.rows());
    if (l == 0) {
      mask_.resize(std::max(mask_.size(), size));
      for (int v = 0; v < of.rows(); ++v)
        for (std::size_t u = 0; u < cols; ++u)
          mask_[static_cast<std::size_t>(v) * cols + u] = static_cast<float>(finest.bytes.ptr(v)[u]) >= kSaturatedGrey;
      spread(mask_.data(), of.cols(), of.rows(), 1, mask_.data(), scratch_);
    } else {  // halving mixes 5 x 5 pixels
      const PyramidLevel& before = pyramid_.level(l - 1);
      spread(mask_.data(), before.cols(), before.rows(), 2, mask_.data(), scratch_);
      const auto stride = 2 * static_cast<std::size_t>(before.cols());
      for (std::size_t v = 0; v < static_cast<std::size_t>(of.rows());
           ++v)  // never writes before what is still to read
        for (std::size_t u = 0; u < cols; ++u) mask_[v * cols + u] = mask_[v * stride + 2 * u];
    }
    if (values_.size() < glare_.size()) values_.resize(glare_.size());
    std::vector<float>& values = values_[static_cast<std::size_t>(l)];
    values.resize(std::max(values.size(), size));
    std::copy(mask_.begin(), mask_.begin() + static_cast<std::ptrdiff_t>(size), values.begin());
    level.image = cv::Mat(of.rows(), of.cols(), CV_32FC1, values.data());
  }
}

}  // namespace heartservo::tracking
