#pragma once
// The inner loops of the bending's normal equations (bend_equations.hpp): the points of one cell of the spline. All
// nine control points that move a point enter by products of a spline along x and one along y, so that the sums over
// the points separate: 6 products of two splines along y times 6 along x for each of 6 quantities, instead of the 434
// products of 28 columns of a Jacobian.
#include <cstddef>

namespace heartservo::tracking::simd {

inline constexpr int kMostLanes = 16;

/// Pointers to the cell's first point in arrays of the whole template, row by row.
struct BendCell {
  const float *grey, *residual, *weight, *gradient_x, *gradient_y, *gain_offset;
  std::ptrdiff_t stride;
  int columns, rows;     ///< of points
  const float* along_x;  ///< three splines, `along_stride` values each; 0 from `columns` on
  std::ptrdiff_t along_stride;
  const float* along_y;  ///< of each row three
  float gain, share;     ///< of the template's gradient
  float half_gain;       ///< (1 - share) * 1/2 (central difference) / step
};

/// Products of two of three splines, in this order.
inline constexpr int kPairOf[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

/// Weighted sums over the cell; gx, gy: gradients, g: grey, r: residual. First index: the pair (or the spline) along y,
/// second: along x.
struct BendSums {
  float squares[6][6][6];  ///< of gx gx, gx gy, gx g, gy gy, gy g, g g
  float singles[3][3][3];  ///< of gx, gy, g
  float residuals[3][3][3];  ///< of gx r, gy r, g r
  float weight, residual;
};

/// Adds up the cell. `out` is overwritten.
void add_bend_cell(const BendCell& cell, BendSums& out);

}  // namespace heartservo::tracking::simd
