#include "tracking/planar/spread.hpp"

#include <algorithm>
#include <cstddef>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

namespace {

HEARTSERVO_SIMD void greater(const std::uint8_t* __restrict from, int n, std::uint8_t* __restrict to) {
#pragma omp simd
  for (int i = 0; i < n; ++i) to[i] = to[i] < from[i] ? from[i] : to[i];
}

}  // namespace

void spread(const std::uint8_t* from, int cols, int rows, int reach, std::uint8_t* to,
            std::vector<std::uint8_t>& scratch) {
  const auto width = static_cast<std::size_t>(cols), size = width * static_cast<std::size_t>(rows);
  scratch.resize(std::max(scratch.size(), size));
  std::copy(from, from + size, scratch.begin());
  for (std::size_t row = 0; row < size; row += width)
    for (int d = 1; d <= std::min(reach, cols - 1); ++d) {
      greater(from + row + d, cols - d, scratch.data() + row);
      greater(from + row, cols - d, scratch.data() + row + d);
    }
  std::copy(scratch.data(), scratch.data() + size, to);
  for (int d = 1; d <= std::min(reach, rows - 1); ++d) {
    const auto shift = width * static_cast<std::size_t>(d);
    for (std::size_t row = 0; row + shift < size; row += width) {
      greater(scratch.data() + row + shift, cols, to + row);
      greater(scratch.data() + row, cols, to + row + shift);
    }
  }
}

}  // namespace heartservo::tracking
