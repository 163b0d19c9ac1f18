#include "tracking/planar/noise_of.hpp"

#include <cmath>

namespace heartservo::tracking {

double noise_of(const Patch& patch) {
  double sum = 0, n = 0;
  for (int row = 1; row + 1 < patch.height; ++row)
    for (int column = 1; column + 1 < patch.width; ++column) {
      const auto i = static_cast<std::size_t>(row * patch.width + column), w = static_cast<std::size_t>(patch.width);
      if (!(patch.usable[i] > 0)) continue;
      const float* g = &patch.grey[i];
      const float* up = g - w;
      const float* down = g + w;
      const float mask = up[-1] + up[1] + down[-1] + down[1] - 2 * (up[0] + down[0] + g[-1] + g[1]) + 4 * g[0];
      sum += static_cast<double>(std::abs(mask));
      ++n;
    }
  return n > 0 ? std::sqrt(M_PI / 2) * sum / (6 * n) : 0;
}

}  // namespace heartservo::tracking
