#include "tracking/planar/simd/copy_marked.hpp"

#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/planar/simd/copy_marked.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace heartservo::tracking::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

bool copy_row(const unsigned char* from, std::size_t n, int bright, unsigned char* to) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t lanes = hn::Lanes(d);
  if (bright > 255) bright = 256;
  std::size_t i = 0;
  auto any = hn::Zero(d);
  if (bright > 0 && bright < 256) {
    const auto below = hn::Set(d, static_cast<std::uint8_t>(bright - 1));
    for (; i + lanes <= n; i += lanes) {
      const auto v = hn::LoadU(d, from + i), over = hn::SaturatedSub(v, below);  // 0 up to `below`
      const auto is_bright = hn::Not(hn::VecFromMask(d, hn::Eq(over, hn::Zero(d))));
      any = hn::Or(any, is_bright);
      hn::StoreU(hn::Or(v, is_bright), d, to + i);
    }
  }
  bool found = !hn::AllTrue(d, hn::Eq(any, hn::Zero(d)));
  for (; i < n; ++i) {
    const bool is_bright = from[i] >= bright;
    to[i] = is_bright ? 255 : from[i];
    found |= is_bright;
  }
  return found;
}

}  // namespace HWY_NAMESPACE
}  // namespace heartservo::tracking::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace heartservo::tracking::simd {
HWY_EXPORT(copy_row);
bool copy_marked(const unsigned char* from, std::size_t n, int bright, unsigned char* to) {
  return HWY_DYNAMIC_DISPATCH(copy_row)(from, n, bright, to);
}
}  // namespace heartservo::tracking::simd
#endif
