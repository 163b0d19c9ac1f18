#pragma once
// The three matrices that texture features are made of. Levels count from 0 here; the features' formulas count them
// from 1, as the literature does.
#include <array>
#include <cstdint>
#include <vector>

#include "tracking/texture/levels.hpp"

namespace heartservo::tracking {

/// Directions of pairs and runs, to be combined; an angle is counter-clockwise in the picture as seen.
enum Directions : unsigned {
  DIRECTION_0 = 1,
  DIRECTION_45 = 2,
  DIRECTION_90 = 4,
  DIRECTION_135 = 8,
  ALL_DIRECTIONS = 15
};

/// Grey-level co-occurrence, Haralick 1973: count(i, j) pixel pairs of levels i and j at the given distance, symmetric
/// (each pair counts as (i, j) and as (j, i)) and summed over the directions.
struct CooccurrenceMatrix {
  int levels = 0, stride = 0;         ///< stride = levels + 1: the last row and column take pixels that are left out
  std::vector<std::uint32_t> counts;  ///< (levels + 1) x stride

  void reset(int level_count);  ///< all zero
  const std::uint32_t* row(int i) const { return counts.data() + static_cast<std::ptrdiff_t>(i) * stride; }
  std::uint32_t count(int i, int j) const { return row(i)[j]; }
  bool operator==(const CooccurrenceMatrix& other) const;
};

/// Run lengths, Galloway 1975: count(i, n) maximal runs of n pixels of level i, summed over the directions. Runs are
/// cut at the region's border; the longest possible run is the region's longer side, and nothing is capped.
struct RunLengthMatrix {
  int levels = 0, longest = 0, stride = 0;  ///< stride = longest + 1: column 0 is scratch
  std::vector<std::uint32_t> counts;        ///< (levels + 1) x stride; the last row takes pixels that are left out
  std::vector<double> inverse_square;       ///< 1 / n^2 for n = 0 (0) .. longest

  void reset(int level_count, int longest_run);  ///< all zero
  const std::uint32_t* row(int i) const { return counts.data() + static_cast<std::ptrdiff_t>(i) * stride; }
  std::uint32_t count(int i, int n) const { return row(i)[n]; }
  bool operator==(const RunLengthMatrix& other) const;
};

/// Pixels of each level.
struct LevelHistogram {
  int levels = 0;
  std::vector<std::uint32_t> counts;  ///< levels + 1; the last takes pixels that are left out

  void reset(int level_count);  ///< all zero
  bool operator==(const LevelHistogram& other) const;
};

struct TextureMatrices {
  CooccurrenceMatrix pairs;
  RunLengthMatrix runs;
  LevelHistogram histogram;

  bool operator==(const TextureMatrices&) const = default;
};

/// Builds the three from a region. Keeps its scratch memory: allocates only for a larger region or more levels than
/// before. `distance` as TextureSettings; a distance the region is too small for gives no pairs.
class MatrixBuilder {
 public:
  void build(const LevelRegion& region, int distance, TextureMatrices& out, unsigned directions = ALL_DIRECTIONS);

 private:
  void count_pairs(const LevelRegion& region, int distance);
  void count_runs(const LevelRegion& region, int stride);

  // A table for each direction: neighbouring pixels often hit the same cell, and the processor would wait for itself.
  std::array<std::vector<std::uint32_t>, 4> pair_tables_, run_tables_;
  std::array<std::vector<std::uint32_t>, 3> open_runs_;  // cell of the run that reaches each column of the last row
};

}  // namespace heartservo::tracking
