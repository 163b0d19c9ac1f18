#pragma once
#include <cstdint>
#include <vector>

namespace heartservo::sim {

/// Gaussian picture noise: a long table drawn once, read from a place that depends on seed, frame and row.
class NoiseTable {
 public:
  NoiseTable(double sigma, int width, std::uint64_t seed);

  /// `width` values for one row of one frame.
  const float* row(std::uint64_t frame_index, int v) const;

 private:
  static constexpr std::uint32_t kStarts = 1u << 16;  // possible places
  std::uint64_t seed_;
  std::vector<float> values_;
};

}  // namespace heartservo::sim
