#include "tracking/planar/simd/select.hpp"

#include <bit>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/planar/simd/select.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace heartservo::tracking::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Binary search on the bits, which as whole numbers are in the order of the values.
float select_bits(const float* values, std::size_t n, std::size_t k) {
  const hn::ScalableTag<std::int32_t> d;
  const std::size_t lanes = hn::Lanes(d);
  std::int32_t found = 0;
  for (std::int32_t bit = 1 << 30; bit > 0; bit >>= 1) {
    const auto candidate = hn::Set(d, found | bit);
    auto below = hn::Zero(d);  // minus their number
    for (std::size_t i = 0; i < n; i += lanes) {
      const auto v = hn::Load(d, reinterpret_cast<const std::int32_t*>(values + i));
      below = hn::Add(below, hn::VecFromMask(d, hn::Lt(v, candidate)));
    }
    if (-hn::GetLane(hn::SumOfLanes(d, below)) <= static_cast<std::int32_t>(k)) found |= bit;
  }
  return std::bit_cast<float>(found);
}

}  // namespace HWY_NAMESPACE
}  // namespace heartservo::tracking::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace heartservo::tracking::simd {
HWY_EXPORT(select_bits);
float select(const float* values, std::size_t n, std::size_t k) {
  return HWY_DYNAMIC_DISPATCH(select_bits)(values, n, k);
}
}  // namespace heartservo::tracking::simd
#endif
