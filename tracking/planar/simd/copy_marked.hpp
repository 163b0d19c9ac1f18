#pragma once
#include <cstddef>

namespace heartservo::tracking::simd {

/// Copies n pixels; those of at least `bright` (0 to 256) become 255. Returns whether there are any.
bool copy_marked(const unsigned char* from, std::size_t n, int bright, unsigned char* to);

}  // namespace heartservo::tracking::simd
