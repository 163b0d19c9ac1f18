#include "tracking/texture/levels.hpp"

#include <algorithm>
#include <array>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

namespace {

HEARTSERVO_SIMD void full_range_row(const std::uint8_t* __restrict grey, int width, int levels,
                                    std::uint8_t* __restrict level) {
  const auto factor = static_cast<std::uint16_t>(levels);
  for (int x = 0; x < width; ++x)
    level[x] = static_cast<std::uint8_t>(static_cast<std::uint16_t>(grey[x] * factor) >> 8);
}

// {darkest, brightest} of the usable pixels; {0, 255} when there are none.
std::array<int, 2> own_range(const GreyRegion& grey, const GreyRegion* usable) {
  int low = 255, high = 0;
  for (int y = 0; y < grey.height; ++y)
    for (int x = 0; x < grey.width; ++x) {
      if (usable && usable->data[y * usable->stride + x] == 0) continue;
      const int g = grey.data[y * grey.stride + x];
      low = std::min(low, g);
      high = std::max(high, g);
    }
  return low <= high ? std::array<int, 2>{low, high} : std::array<int, 2>{0, 255};
}

void own_range_levels(const GreyRegion& grey, const GreyRegion* usable, LevelImage& out) {
  const auto [low, high] = own_range(grey, usable);
  std::array<std::uint8_t, 256> level{};
  for (int g = low; g <= high; ++g)
    level[static_cast<std::size_t>(g)] = static_cast<std::uint8_t>(out.levels * (g - low) / (high - low + 1));
  for (int y = 0; y < grey.height; ++y) {
    const std::uint8_t* from = grey.data + y * grey.stride;
    std::uint8_t* to = out.data.data() + static_cast<std::ptrdiff_t>(y) * out.width;
    for (int x = 0; x < grey.width; ++x) to[x] = level[from[x]];
  }
}

}  // namespace

GreyRegion grey_region(const cv::Mat& grey, const cv::Rect& where) {
  return {grey.ptr<std::uint8_t>(where.y) + where.x, where.width, where.height,
          static_cast<std::ptrdiff_t>(grey.step[0])};
}

void quantise(const GreyRegion& grey, const TextureSettings& settings, LevelImage& out, const GreyRegion* usable) {
  out.width = grey.width;
  out.height = grey.height;
  out.levels = settings.levels;
  out.data.resize(static_cast<std::size_t>(grey.width) * static_cast<std::size_t>(grey.height));
  if (settings.range == "own") {
    own_range_levels(grey, usable, out);
  } else {
    for (int y = 0; y < grey.height; ++y)
      full_range_row(grey.data + y * grey.stride, grey.width, out.levels,
                     out.data.data() + static_cast<std::ptrdiff_t>(y) * out.width);
  }
  if (!usable) return;
  for (int y = 0; y < grey.height; ++y)
    for (int x = 0; x < grey.width; ++x)
      if (usable->data[y * usable->stride + x] == 0)
        out.data[static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width) + static_cast<std::size_t>(x)] =
            static_cast<std::uint8_t>(out.levels);
}

}  // namespace heartservo::tracking
