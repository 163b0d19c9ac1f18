#include "sim/endoscope/painted_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

namespace heartservo::sim {
namespace {

/// Pseudorandom in [-1, 1] from integers.
double cell(std::uint32_t id, int i, int j) {
  std::uint32_t h =
      id * 0x9e3779b9u + static_cast<std::uint32_t>(i) * 0x85ebca6bu + static_cast<std::uint32_t>(j) * 0xc2b2ae35u;
  h ^= h >> 16, h *= 0x7feb352du, h ^= h >> 15, h *= 0x846ca68bu, h ^= h >> 16;
  return h / 2147483647.5 - 1;
}

double smooth(double f) { return f * f * (3 - 2 * f); }

/// Value noise: random values on the integer grid, smoothly joined.
double noise(std::uint32_t id, double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y);
  const int i = static_cast<int>(fx), j = static_cast<int>(fy);
  const double u = smooth(x - fx), v = smooth(y - fy);
  const double top = cell(id, i, j) + u * (cell(id, i + 1, j) - cell(id, i, j));
  const double bottom = cell(id, i, j + 1) + u * (cell(id, i + 1, j + 1) - cell(id, i, j + 1));
  return top + v * (bottom - top);
}

/// `cells` cells across the plate, turned by `angle`.
double turned(std::uint32_t id, double x, double y, double cells, double angle) {
  const double c = std::cos(angle) * cells / 2, s = std::sin(angle) * cells / 2;
  return noise(id, c * x - s * y + 17.37, s * x + c * y + 31.61);
}

double step(double distance) { return 0.5 * (1 + std::tanh(distance / 0.012)); }

double mix(double a, double b, double t) { return a + t * (b - a); }

cv::Mat paint(std::uint32_t id, int size) {
  constexpr int kSamples = 2;
  cv::Mat picture(size, size, CV_8UC1);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      double grey = 0;
      for (int k = 0; k < kSamples * kSamples; ++k)
        grey += painted_pattern(id, 2 * (i + (k % kSamples + 0.5) / kSamples) / size - 1,
                                2 * (j + (k / kSamples + 0.5) / kSamples) / size - 1);
      picture.at<std::uint8_t>(j, i) = cv::saturate_cast<std::uint8_t>(grey / (kSamples * kSamples));
    }
  return picture;
}

}  // namespace

double painted_pattern(std::uint32_t id, double x, double y) {
  const double rim = std::max(std::abs(x), std::abs(y));
  const double value = 0.9 * turned(3 * id + 1, x, y, 3.3, 0.41) + 0.75 * turned(3 * id + 2, x, y, 7.9, 1.13) +
                       0.5 * turned(3 * id + 3, x, y, 14.7, 2.02);
  // Three paints: dark, middle, light, mixed with the continuous value so that no area is flat.
  const double pressed = std::tanh(7 * (value - 0.28)) + std::tanh(7 * (value + 0.28));
  const double paint = std::clamp(105 + 18 * pressed + 62 * value, 12.0, 200.0);
  // Soft edges, wider than a texel: a hard one would snap to the texture's grid.
  const double framed = mix(paint, 25, step(rim - 0.7));
  return mix(framed, 195, step(rim - kFrameEdge));
}

cv::Mat pattern_picture(std::uint32_t id, int size) {
  // Painting takes a tenth of a second or more, and everyone who looks at a region asks for it.
  static std::mutex mutex;
  static std::map<std::pair<std::uint32_t, int>, cv::Mat> painted;
  const std::lock_guard lock(mutex);
  cv::Mat& picture = painted[{id, size}];
  if (picture.empty()) picture = paint(id, size);
  return picture.clone();
}

}  // namespace heartservo::sim
