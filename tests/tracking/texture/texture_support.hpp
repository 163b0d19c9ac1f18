#pragma once
// Small pictures of levels, and texture matrices counted the plain way, by the definition, to compare with.
#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "tests/support/random.hpp"
#include "tracking/texture/matrices.hpp"

namespace heartservo::test {

using Rows = std::vector<std::vector<std::uint32_t>>;

inline tracking::LevelImage level_image(int levels, const std::vector<std::vector<int>>& rows) {
  tracking::LevelImage image{static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), levels, {}};
  for (const auto& row : rows)
    for (const int level : row) image.data.push_back(static_cast<std::uint8_t>(level));
  return image;
}

/// Levels with runs of all lengths: each pixel repeats a neighbour's level with a chance that varies over the picture.
/// With `left_out` some pixels are marked as left out.
inline tracking::LevelImage random_levels(std::mt19937_64& random, int width, int height, int levels,
                                          bool left_out = false) {
  tracking::LevelImage image{width, height, levels, {}};
  std::uniform_int_distribution<int> level(0, left_out ? levels : levels - 1), way(0, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double repeat = 0.9 * x / width;
      constexpr std::array<std::array<int, 2>, 4> kFrom{{{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
      const auto [dx, dy] = kFrom[static_cast<std::size_t>(way(random))];
      const bool inside = x + dx >= 0 && x + dx < width && y + dy >= 0;
      image.data.push_back(uniform(random, 0, 1) < repeat && inside
                               ? image.data[static_cast<std::size_t>((y + dy) * width + x + dx)]
                               : static_cast<std::uint8_t>(level(random)));
    }
  return image;
}

inline void count_plainly(const tracking::LevelRegion& r, int distance, tracking::TextureMatrices& m) {
  m.pairs.reset(r.levels);
  m.runs.reset(r.levels, std::max(r.width, r.height));
  m.histogram.reset(r.levels);
  const auto at = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < r.width && y < r.height ? static_cast<int>(r.row(y)[x]) : -1;
  };
  for (int y = 0; y < r.height; ++y)
    for (int x = 0; x < r.width; ++x) {
      const int a = at(x, y);
      if (a == r.levels) continue;
      ++m.histogram.counts[static_cast<std::size_t>(a)];
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int b = at(x + distance * dx, y + distance * dy);
          if ((dx != 0 || dy != 0) && b >= 0 && b < r.levels)
            ++m.pairs.counts[static_cast<std::size_t>(a * m.pairs.stride + b)];
        }
      constexpr std::array<std::array<int, 2>, 4> kOn{{{1, 0}, {1, -1}, {0, 1}, {1, 1}}};
      for (const auto [dx, dy] : kOn) {
        if (at(x - dx, y - dy) == a) continue;  // not the run's first pixel
        int n = 1;
        while (at(x + n * dx, y + n * dy) == a) ++n;
        ++m.runs.counts[static_cast<std::size_t>(a * m.runs.stride + n)];
      }
    }
}

}  // namespace heartservo::test
