#pragma once
// Grey values to a few grey levels, the first step of every texture matrix.
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "tracking/settings/fields.hpp"

namespace heartservo::tracking {

/// Levels that a texture matrix may have.
inline constexpr int kMaxLevels = 64;

/// How texture is described. Co-occurrence and run lengths are taken in four directions (0, 45, 90, 135 degrees).
struct TextureSettings {
  int levels = 32;
  int distance = 1;
  std::string range = "full";

  void fields(FieldVisitor& v) {
    v.field({"levels", "", "grey levels of the co-occurrence and run-length matrices", 2, kMaxLevels}, levels);
    v.field({"distance", "px", "between the two pixels of a co-occurrence; along both axes on the diagonals", 1, 64},
            distance);
    v.choice({"range", "", "grey values divided into levels: 0 to 255, or the region's own darkest to brightest"},
             range, {"full", "own"});
  }
};

/// A rectangle of 8-bit grey values: rows `stride` bytes apart.
struct GreyRegion {
  const std::uint8_t* data = nullptr;
  int width = 0, height = 0;  ///< px
  std::ptrdiff_t stride = 0;  ///< bytes
};

/// The part `where` of a CV_8UC1 picture, which has to contain it and to outlive the result.
GreyRegion grey_region(const cv::Mat& grey, const cv::Rect& where);

/// A rectangle of levels 0 .. levels - 1. The value `levels` marks a pixel that is left out: it belongs to no pair, no
/// run and no histogram, and it cuts runs.
struct LevelRegion {
  const std::uint8_t* data = nullptr;
  int width = 0, height = 0, levels = 0;
  std::ptrdiff_t stride = 0;

  const std::uint8_t* row(int y) const { return data + y * stride; }
};

/// Levels that own their memory, rows without gaps.
struct LevelImage {
  int width = 0, height = 0, levels = 0;
  std::vector<std::uint8_t> data;

  LevelRegion region() const { return region(0, 0, width, height); }
  LevelRegion region(int x, int y, int region_width, int region_height) const {
    return {data.data() + static_cast<std::ptrdiff_t>(y) * width + x, region_width, region_height, levels, width};
  }
};

/// Grey value g to level floor(levels (g - low) / (high - low + 1)), where low, high are 0, 255 for the range "full"
/// and the darkest and brightest used grey value of the region for "own". `usable`, unless null: same size as `grey`, 0
/// where a pixel is to be left out (glare, a tool). Allocates only when `out` has to grow.
void quantise(const GreyRegion& grey, const TextureSettings& settings, LevelImage& out,
              const GreyRegion* usable = nullptr);

}  // namespace heartservo::tracking
