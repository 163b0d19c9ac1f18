// Words from scattered addresses, for the kernels. No include guard of the usual kind: the file is included once for each
// instruction set (see Highway's foreach_target.h).
//
// The gather instructions of many processors take longer than loading every word by itself (AMD's; Intel's since the
// mitigation of CVE-2022-40982), so words are loaded one by one and put together in registers.
#if defined(HEARTSERVO_FETCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEARTSERVO_FETCH_INL
#undef HEARTSERVO_FETCH_INL
#else
#define HEARTSERVO_FETCH_INL
#endif

#include <hwy/highway.h>

#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace heartservo::tracking::simd {
namespace HWY_NAMESPACE {

using FetchInts = hwy::HWY_NAMESPACE::ScalableTag<std::int32_t>;

/// Where a vector of words begins, bytes from some base.
struct Addresses {
  alignas(64) std::int32_t at[HWY_MAX_BYTES / sizeof(std::int32_t)];
  explicit HWY_INLINE Addresses(hwy::HWY_NAMESPACE::Vec<FetchInts> bytes) {
    hwy::HWY_NAMESPACE::Store(bytes, FetchInts(), at);
  }
};

/// The 32-bit words at base + at[i].
HWY_INLINE hwy::HWY_NAMESPACE::Vec<FetchInts> fetch(const void* base, const Addresses& a) {
  const auto word = [&](int i) HWY_ATTR {
    std::int32_t w;
    std::memcpy(&w, static_cast<const char*>(base) + a.at[i], sizeof(w));
    return w;
  };
#if HWY_TARGET == HWY_AVX2
  return hwy::HWY_NAMESPACE::Vec<FetchInts>{
      _mm256_set_epi32(word(7), word(6), word(5), word(4), word(3), word(2), word(1), word(0))};
#elif HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_SSSE3
  return hwy::HWY_NAMESPACE::Vec<FetchInts>{_mm_set_epi32(word(3), word(2), word(1), word(0))};
#elif HWY_TARGET <= HWY_AVX3
  return hwy::HWY_NAMESPACE::Vec<FetchInts>{_mm512_set_epi32(
      word(15), word(14), word(13), word(12), word(11), word(10), word(9), word(8), word(7), word(6), word(5), word(4),
      word(3), word(2), word(1), word(0))};
#else
  alignas(64) std::int32_t words[HWY_MAX_BYTES / sizeof(std::int32_t)];
  for (std::size_t i = 0; i < hwy::HWY_NAMESPACE::Lanes(FetchInts()); ++i) words[i] = word(static_cast<int>(i));
  return hwy::HWY_NAMESPACE::Load(FetchInts(), words);
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace heartservo::tracking::simd
HWY_AFTER_NAMESPACE();

#endif
