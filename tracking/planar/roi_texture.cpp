#include "tracking/planar/roi_texture.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::tracking {

namespace {

constexpr float kRange = 2.5F;       // standard deviations of the template's greys to either side of their mean
constexpr float kSmallestRange = 8;  // grey levels to either side

TextureSettings settings_of(int levels) {
  TextureSettings settings;
  settings.levels = levels;
  return settings;
}

float deviation(const UprightView& view) {
  double n = 0, sum = 0, squares = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    const double grey = static_cast<double>(view.grey[i]);
    n += static_cast<double>(view.clear[i]), sum += grey, squares += grey * grey;
  }
  return n > 0 ? static_cast<float>(std::sqrt(std::max(0.0, squares / n - sum / n * sum / n))) : 0;
}

}  // namespace

RoiTexture::RoiTexture(int levels, const UprightView& reference, float mean)
    : levels_(levels), mean_(mean), sliding_(settings_of(levels), reference.grid.width, reference.grid.height) {
  if (reference.size() == 0) return;
  const float half = std::max(kSmallestRange, kRange * deviation(reference));
  low_ = mean - half;
  high_ = mean + half;
  load(reference, Light{});
  sliding_.place(0, 0);
  reference_ = texture_vector(sliding_.matrices());
}

void RoiTexture::load(const UprightView& view, const Light& light) {
  quantise(view, light);
  sliding_.load(image_.region());
  placed_ = false;
}

void RoiTexture::quantise(const UprightView& view, const Light& light) {
  image_.width = view.grid.width;
  image_.height = view.grid.height;
  image_.levels = levels_;
  image_.data.resize(view.size());
  const float per_grey = static_cast<float>(levels_) / (high_ - low_), gain = static_cast<float>(light.gain) * per_grey,
              bias = (static_cast<float>(light.bias + light.gain * static_cast<double>(mean_)) - low_) * per_grey,
              last = static_cast<float>(levels_ - 1);
  const auto hidden = static_cast<std::uint8_t>(levels_);
  for (std::size_t i = 0; i < view.size(); ++i) {
    const float level = std::clamp(gain * view.grey[i] + bias, 0.0F, last);
    image_.data[i] = view.clear[i] > 0 ? static_cast<std::uint8_t>(level) : hidden;
  }
}

double RoiTexture::distance(int x, int y) {
  if (placed_)
    sliding_.move_to(x, y);
  else
    sliding_.place(x, y);
  placed_ = true;
  return texture_distance(reference_, texture_vector(sliding_.matrices()));
}

}  // namespace heartservo::tracking
