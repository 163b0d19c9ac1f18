#include "tracking/planar/bend_equations.hpp"

#include <algorithm>
#include <array>

#include "tracking/planar/simd/bend_kernel.hpp"

namespace heartservo::tracking {

namespace {

// First and one past the last grid line of each cell; at most kMaxBendPoints cells.
struct Range {
  int begin = 0, end = 0;
};
template <class Basis>
void find_cells(int lines, const Basis& basis, std::array<Range, kMaxBendPoints>& cells) {
  cells.fill({});
  for (int i = 1; i + 1 < lines; ++i) {  // the outermost points have no gradient
    Range& cell = cells[static_cast<std::size_t>(basis(i).first)];
    if (cell.end == 0) cell.begin = i;
    cell.end = i + 1;
  }
}

// Which of BendSums::squares is the product of parts p and q (x, y, gain).
constexpr int kSquareOf[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

void scatter(const simd::BendSums& s, int first_column, int first_row, int columns, BendEquations& e) {
  const int bias = static_cast<int>(e.Jtr.size()) - 1;
  const auto unknown = [&](int row, int column, int part) {
    return 3 * ((first_row + row) * columns + first_column + column) + part;
  };
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      for (int p = 0; p < 3; ++p) {
        const int i = unknown(r, c, p);
        for (int r2 = 0; r2 <= r; ++r2)
          for (int c2 = 0; c2 < 3; ++c2)
            for (int q = 0; q < 3; ++q)
              if (const int j = unknown(r2, c2, q); j <= i)
                e.JtJ(i, j) += static_cast<double>(
                    s.squares[kSquareOf[p][q]][simd::kPairOf[r][r2]][simd::kPairOf[c][c2]]);
        e.JtJ(bias, i) += static_cast<double>(s.singles[p][r][c]);
        e.Jtr(i) += static_cast<double>(s.residuals[p][r][c]);
      }
  e.JtJ(bias, bias) += static_cast<double>(s.weight);
  e.Jtr(bias) += static_cast<double>(s.residual);
}

}  // namespace

void BendEquations::resize(int control_points) {
  const int n = 3 * control_points + 1;
  JtJ.setZero(n, n);
  Jtr.setZero(n);
}

void BendEquations::clear(int band) {
  const int n = static_cast<int>(Jtr.size());
  for (int i = 0; i + 1 < n; ++i) {
    const int first = std::max(0, i - band);
    JtJ.row(i).segment(first, i - first + 1).setZero();
  }
  JtJ.row(n - 1).setZero();
  Jtr.setZero();
}

int band_of(const SplineBend& spline) { return 3 * (2 * spline.columns() + 2) + 2; }

void add_bend_pass(const Patch& patch, const Light& light, const BentGrid& grid, const AlignmentBuffers& b,
                   BendEquations& equations) {
  std::array<Range, kMaxBendPoints> cells_x, cells_y;
  find_cells(
      patch.width, [&](int i) { return grid.column(i); }, cells_x);
  find_cells(
      patch.height, [&](int i) { return grid.row(i); }, cells_y);
  const int columns = grid.spline().columns(), rows = grid.spline().rows();
  simd::BendSums sums;
  for (int cx = 0; cx + 2 < columns; ++cx)
    for (int cy = 0; cy + 2 < rows; ++cy) {
      const Range across = cells_x[static_cast<std::size_t>(cx)], down = cells_y[static_cast<std::size_t>(cy)];
      if (across.end == across.begin || down.end == down.begin) continue;
      const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(down.begin) * patch.width + across.begin;
      const simd::BendCell cell{b.grey.data() + i,
                                b.residual.data() + i,
                                b.weight.data() + i,
                                patch.gradient_x.data() + i,
                                patch.gradient_y.data() + i,
                                light.gain_offset + i,
                                patch.width,
                                across.end - across.begin,
                                down.end - down.begin,
                                grid.along_x(across.begin),
                                grid.basis_stride(),
                                grid.along_y(down.begin),
                                static_cast<float>(light.gain),
                                patch.template_share,
                                (1 - patch.template_share) * 0.5F / patch.step};
      simd::add_bend_cell(cell, sums);
      scatter(sums, cx, cy, columns, equations);
    }
}

}  // namespace heartservo::tracking
