#pragma once
#include <cstddef>

namespace heartservo::tracking::simd {

/// The k-th smallest (from 0) of n values >= 0, none of them NaN. `values` is aligned to 64 bytes and readable up to a
/// multiple of 16 values, the ones beyond n being infinite. Takes the same time whatever the values are.
float select(const float* values, std::size_t n, std::size_t k);

}  // namespace heartservo::tracking::simd
