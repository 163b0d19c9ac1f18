#pragma once
// The points of a patch under a SplineBend, with everything that does not change from frame to frame worked out once.
#include <cstddef>
#include <vector>

#include "tracking/planar/patch.hpp"
#include "tracking/planar/spline_bend.hpp"

namespace heartservo::tracking {

/// The bend of a region of side_x x side_y px, cells of about `cell_px`.
SplineBend bend_of(int side_x, int side_y, double cell_px);

class BentGrid {
 public:
  BentGrid(const SplineBend& bend, const Patch& patch);

  /// The bent points, in patch coordinates, and their gains; valid until the next call.
  BentPoints bend(const BendField& field);

  const SplineBend& spline() const { return bend_; }
  const SplineBend::Basis& column(int i) const { return columns_[static_cast<std::size_t>(i)]; }
  const SplineBend::Basis& row(int i) const { return rows_[static_cast<std::size_t>(i)]; }

  /// The three splines along x at a column and those after it, basis_stride() values each, readable 16 beyond the last.
  const float* along_x(int column) const { return &along_x_[static_cast<std::size_t>(column)]; }
  std::ptrdiff_t basis_stride() const { return stride_; }
  /// The three splines along y at a row, then those of the rows after it.
  const float* along_y(int row) const { return &along_y_[static_cast<std::size_t>(3 * row)]; }

 private:
  SplineBend bend_;
  std::vector<SplineBend::Basis> columns_, rows_;
  std::vector<int> cell_end_;  // of each cell along x: one past its last column
  std::vector<float> rest_x_, rest_y_, x_, y_, gain_offset_;
  std::ptrdiff_t stride_ = 0;
  std::vector<float> along_x_, along_y_;
};

}  // namespace heartservo::tracking
