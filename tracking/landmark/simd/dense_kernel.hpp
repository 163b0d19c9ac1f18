#pragma once
// The inner loops of the dense pose: predict_grey() (dense_equations.hpp, which says the equations) for eight or sixteen
// pixels at a time, in floats.
#include <cstddef>
#include <cstdint>

#include "tracking/landmark/dense_equations.hpp"

namespace heartservo::tracking::simd {

inline constexpr int kDenseRow = kDenseParameters + 1;  // and the residual

struct DenseJob {
  const std::int32_t* nodes;  ///< LandmarkTemplate::packed()
  float reach;
  float right[3], down[3], normal[3], centre[3];  ///< of the PlateView
  float half_side_m;
  float light[kLightParameters];
};

DenseJob dense_job(const LandmarkTemplate& plate, const PlateView& view, const DenseLight& light);

/// Pixels, arrays padded to kDensePad more with weight 0. Rays are (x, y, 1).
struct DensePixels {
  std::size_t n = 0;
  const float *ray_x, *ray_y, *grey;
  float *residual, *weight;
};
inline constexpr std::size_t kDensePad = 16;

/// Of one row of the picture: adds the pixels that lie on the plate and whose grey is above 0 and below `saturated` to
/// the arrays, and returns how many; `covered` counts all on the plate. `rays`: x and y of each pixel in turn. The
/// arrays must have room for `n` and kDensePad more.
std::size_t collect_row(const DenseJob& job, const float* rays, const unsigned char* grey, std::size_t n,
                        float saturated, float* ray_x, float* ray_y, float* out_grey, std::size_t& covered);

/// The template's grey level at each pixel, into `residual`.
void sample_plate(const DenseJob& job, const DensePixels& pixels);

/// residual = grey - predicted; where the template does not reach, residual and weight become 0.
void predict(const DenseJob& job, const DensePixels& pixels);

/// The same, and the weighted products of (row, residual): kDenseRow * kDenseRow sums, of which the upper triangle holds.
void add_normal(const DenseJob& job, const DensePixels& pixels, double* sums);

}  // namespace heartservo::tracking::simd
