#include "tracking/texture/texture_vector.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/texture/cooccurrence_features.hpp"
#include "tracking/texture/first_order_features.hpp"
#include "tracking/texture/run_length_features.hpp"

namespace heartservo::tracking {

namespace {

double squash(double value, double half_at) { return value / (std::abs(value) + half_at); }

double log_scale(double value, double lowest) {
  return value > 0 ? std::clamp(1 - std::log(value) / std::log(lowest), 0.0, 1.0) : 0;
}

double pixels_of(const LevelHistogram& histogram) {
  double n = 0;
  for (int i = 0; i < histogram.levels; ++i) n += histogram.counts[static_cast<std::size_t>(i)];
  return n;
}

}  // namespace

TextureVector raw_texture(const TextureMatrices& m) {
  const auto [energy, contrast, shade, prominence] = quick_cooccurrence_features(m.pairs);
  const auto [RLN, SRLGE] = quick_run_length_features(m.runs);
  const auto first_order = first_order_features(m.histogram);
  return {energy, contrast, shade, prominence, RLN, SRLGE, first_order.skewness, first_order.kurtosis};
}

TextureVector texture_vector(const TextureMatrices& m) {
  const double pixels = pixels_of(m.histogram);
  if (pixels <= 0) return {};
  const auto [energy, contrast, shade, prominence, RLN, SRLGE, skewness, kurtosis] = raw_texture(m);
  const double L = m.pairs.levels, grey_range = L - 1, R = m.runs.longest;
  return {log_scale(energy, 1 / (L * L)),
          squash(std::sqrt(contrast) / grey_range, 0.04),
          0.5 + 0.5 * squash(shade / std::pow(2 * grey_range, 3), 1e-3),
          squash(std::sqrt(std::sqrt(prominence)) / (2 * grey_range), 0.1),
          RLN / (4 * pixels),
          log_scale(SRLGE, 1 / (L * R * L * R)),
          0.5 + 0.5 * squash(skewness, 1),
          squash(kurtosis - 1, 2)};
}

double texture_distance(const TextureVector& a, const TextureVector& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

TextureVector TextureDescriber::describe(const GreyRegion& grey, const GreyRegion* usable) {
  quantise(grey, settings_, levels_, usable);
  builder_.build(levels_.region(), settings_.distance, matrices_);
  return texture_vector(matrices_);
}

}  // namespace heartservo::tracking
