#pragma once
// The inner loops of warp() (patch.hpp): samples of a picture under a homography, with or without a lens, eight or
// sixteen at a time. Highway picks the instruction set at run time (SSE4, AVX2, AVX-512), so that a binary runs on
// machines older than the one it was built on.
#include <cstddef>

namespace heartservo::tracking::simd {

/// Everything in floats: 3e-8 on the normalised plane is 2e-5 px.
struct WarpJob {
  /// G (x, y, 1) = origin + x * per_x + y * per_y, then divided by its last element. With `lens` that is a point of the
  /// undistorted plane, else already a pixel of the level.
  float origin[3], per_x[3], per_y[3];
  bool lens;
  float k1, k2, k3, k4;               ///< of the lens
  float u_scale, v_scale, u_add, v_add;  ///< distorted plane -> pixel of the level
  const float* image;                 ///< float pixels of the level, or null:
  const unsigned char* bytes;         ///< 8-bit pixels, readable one row and four pixels beyond their border
  std::ptrdiff_t stride;              ///< pixels per row of whichever
  float border, u_max, v_max;         ///< samples are clamped to [border, ..._max]
  bool cubic;
  int columns, rows;                  ///< of the grid
  float first_x, first_y, step;       ///< patch coordinates of the grid's first point, and from point to point
  const float *bent_x, *bent_y;       ///< columns * rows patch coordinates instead of the grid's, or null
};

/// Grey values of columns * rows points. `inside`: 1, or 0 where the sample was clamped; null: `grey` is kOutside there.
void warp_grid(const WarpJob& job, float* grey, float* inside);

/// Brighter than any glare.
inline constexpr float kOutside = 1000;

}  // namespace heartservo::tracking::simd
