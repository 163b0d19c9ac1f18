#include "sim/endoscope/occlusion.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace heartservo::sim {

void draw_swab(cv::Mat& grey, cv::Point2d centre_px, double radius_px, double noise_grey, std::uint64_t seed) {
  constexpr double kThread_px = 5;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 1);
  const int top = std::max(0, static_cast<int>(centre_px.y - radius_px)),
            bottom = std::min(grey.rows, static_cast<int>(centre_px.y + radius_px) + 2),
            left = std::max(0, static_cast<int>(centre_px.x - radius_px)),
            right = std::min(grey.cols, static_cast<int>(centre_px.x + radius_px) + 2);
  for (int v = top; v < bottom; ++v)
    for (int u = left; u < right; ++u) {
      const double cover = std::clamp(radius_px - std::hypot(u - centre_px.x, v - centre_px.y) + 0.5, 0.0, 1.0);
      const double weave = 175 + 25 * std::sin(u / kThread_px) * std::sin(v / kThread_px);
      const double level = weave + noise_grey * normal(random);
      auto& g = grey.at<std::uint8_t>(v, u);
      g = cv::saturate_cast<std::uint8_t>(g + cover * (level - g));
    }
}

}  // namespace heartservo::sim
