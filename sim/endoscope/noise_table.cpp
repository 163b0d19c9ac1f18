#include "sim/endoscope/noise_table.hpp"

#include <random>

namespace heartservo::sim {
namespace {

/// A bijection of 64-bit numbers that leaves no visible pattern (Stafford's mix 13, as in splitmix64).
std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

}  // namespace

NoiseTable::NoiseTable(double sigma, int width, std::uint64_t seed)
    : seed_(scramble(seed + 0x9e3779b97f4a7c15ull)), values_(kStarts + static_cast<std::size_t>(width)) {
  std::mt19937_64 random(seed_);
  std::normal_distribution<float> normal(0, 1);
  for (float& value : values_) value = static_cast<float>(sigma) * normal(random);
}

const float* NoiseTable::row(std::uint64_t frame_index, int v) const {
  return values_.data() + scramble(seed_ ^ scramble(frame_index * 65536 + static_cast<std::uint64_t>(v))) % kStarts;
}

}  // namespace heartservo::sim
