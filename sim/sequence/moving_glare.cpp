#include "sim/sequence/moving_glare.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace heartservo::sim {

namespace {
constexpr float kGlare_grey = 600;  // saturated at any gain
}

MovingGlare::MovingGlare(int blobs, const Eigen::Vector2d& centre_px, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto draw = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  for (int i = 0; i < blobs; ++i) {
    Blob blob;
    blob.middle.x() = centre_px.x() + draw(-90, 90);
    blob.middle.y() = centre_px.y() + draw(-90, 90);
    blob.amplitude.x() = draw(15, 60);
    blob.amplitude.y() = draw(15, 60);
    blob.period = draw(40, 120);
    blob.phase = draw(0, 2 * M_PI);
    blob.radius = draw(3, 8);
    blobs_.push_back(blob);
  }
}

void MovingGlare::add_to_row(double t, int v, int width, float* grey) const {
  for (const Blob& blob : blobs_) {
    const double angle = 2 * M_PI * t / blob.period + blob.phase, reach = blob.radius + 0.5;
    const double x = blob.middle.x() + blob.amplitude.x() * std::cos(angle);
    const double y = blob.middle.y() + blob.amplitude.y() * std::sin(angle) - v;
    if (std::abs(y) >= reach) continue;
    const double half = std::sqrt(reach * reach - y * y);
    const int from = std::max(0, static_cast<int>(std::ceil(x - half))),
              to = std::min(width - 1, static_cast<int>(std::floor(x + half)));
    for (int u = from; u <= to; ++u) {
      const auto share = static_cast<float>(std::clamp(reach - std::hypot(u - x, y), 0.0, 1.0));
      grey[u] += share * (kGlare_grey - grey[u]);
    }
  }
}

}  // namespace heartservo::sim
