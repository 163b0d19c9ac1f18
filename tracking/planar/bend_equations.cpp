#include "tracking/planar/bend_equations.hpp"

#include <array>
#include <cmath>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

namespace {

constexpr int kLocal = 9;                  // control points that move a cell
constexpr int kUnknowns = 3 * kLocal + 1;  // of a cell
constexpr int kRows = kUnknowns + 1;       // and the residual
constexpr std::size_t kBlock = 128;        // points: the block stays in the first-level cache
using Block = std::array<std::array<float, kBlock>, kRows>;
using Sums = std::array<float, kUnknowns*(kUnknowns + 3) / 2>;  // products of rows a <= b, a < kUnknowns

struct Segment {  // points of one template row that lie in one cell
  const float *grey, *residual, *weight, *template_x, *template_y, *gain_offset;
  std::ptrdiff_t stride;
  const std::array<float, kBlock>* along_x;  // the cell's three splines at these columns
  std::array<float, 3> along_y;
  float gain, share, scale;  // scale: (1 - share) * 1/2 (central difference) / step
};

HEARTSERVO_SIMD void jacobian_segment(const Segment& s, std::size_t n, std::size_t at, Block& J) {
  std::array<float, kBlock> gx, gy, grey;
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    const float root = std::sqrt(s.weight[i]), half_gain = s.scale * (s.gain + s.gain_offset[i]);
    const float* g = s.grey + i;
    gx[i] = root * (s.share * s.template_x[i] + half_gain * (g[1] - g[-1]));
    gy[i] = root * (s.share * s.template_y[i] + half_gain * (g[s.stride] - g[-s.stride]));
    grey[i] = root * g[0];
    J[27][at + i] = root;
    J[28][at + i] = root * s.residual[i];
  }
  for (std::size_t k = 0; k < kLocal; ++k) {
    const float by = s.along_y[k / 3];
    const float* bx = s.along_x[k % 3].data();
    float *jx = J[k].data() + at, *jy = J[kLocal + k].data() + at, *jg = J[2 * kLocal + k].data() + at;
#pragma omp simd
    for (std::size_t i = 0; i < n; ++i) {
      const float b = by * bx[i];
      jx[i] = b * gx[i];
      jy[i] = b * gy[i];
      jg[i] = b * grey[i];
    }
  }
}

HEARTSERVO_SIMD void add_products(const Block& J, std::size_t n, Sums& sums) {
  std::size_t k = 0;
  for (std::size_t a = 0; a < kUnknowns; ++a)
    for (std::size_t b = a; b < kRows; ++b, ++k) {
      const float *p = J[a].data(), *q = J[b].data();
      float sum = 0;
#pragma omp simd reduction(+ : sum)
      for (std::size_t i = 0; i < n; ++i) sum += p[i] * q[i];
      sums[k] += sum;
    }
}

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

void scatter(const Sums& sums, int first_column, int first_row, int columns, BendEquations& e) {
  const auto unknown = [&](int local) {
    if (local == 3 * kLocal) return static_cast<int>(e.Jtr.size()) - 1;
    const int k = local % kLocal, part = local / kLocal;
    return 3 * ((first_row + k / 3) * columns + first_column + k % 3) + part;
  };
  std::size_t k = 0;
  for (int a = 0; a < kUnknowns; ++a) {
    const int i = unknown(a);
    for (int b = a; b < kUnknowns; ++b, ++k) {
      const int j = unknown(b);
      e.JtJ(std::max(i, j), std::min(i, j)) += static_cast<double>(sums[k]);
    }
    e.Jtr(i) += static_cast<double>(sums[k++]);
  }
}

}  // namespace

void BendEquations::resize(int control_points) {
  const int n = 3 * control_points + 1;
  JtJ.resize(n, n);
  Jtr.resize(n);
}

void add_bend_pass(const Patch& patch, const Light& light, const BentGrid& grid, const AlignmentBuffers& b,
                   BendEquations& equations) {
  std::array<Range, kMaxBendPoints> cells_x, cells_y;
  find_cells(
      patch.width, [&](int i) { return grid.column(i); }, cells_x);
  find_cells(
      patch.height, [&](int i) { return grid.row(i); }, cells_y);
  const int columns = grid.spline().columns(), rows = grid.spline().rows();
  Block J;
  std::array<std::array<float, kBlock>, 3> along_x;
  for (int cx = 0; cx + 2 < columns; ++cx)
    for (int cy = 0; cy + 2 < rows; ++cy) {
      const Range across = cells_x[static_cast<std::size_t>(cx)], down = cells_y[static_cast<std::size_t>(cy)];
      Sums sums{};
      std::size_t filled = 0;
      const auto flush = [&] {
        if (filled > 0) add_products(J, filled, sums);
        filled = 0;
      };
      for (int begin = across.begin; begin < across.end; begin += static_cast<int>(kBlock)) {
        const auto n = static_cast<std::size_t>(std::min(across.end - begin, static_cast<int>(kBlock)));
        for (std::size_t i = 0; i < n; ++i)
          for (std::size_t k = 0; k < 3; ++k)
            along_x[k][i] = static_cast<float>(grid.column(begin + static_cast<int>(i)).value[k]);
        for (int row = down.begin; row < down.end; ++row) {
          if (filled + n > kBlock) flush();
          const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(row) * patch.width + begin;
          const auto& by = grid.row(row).value;
          const Segment segment{b.grey.data() + i,
                                b.residual.data() + i,
                                b.weight.data() + i,
                                patch.gradient_x.data() + i,
                                patch.gradient_y.data() + i,
                                light.gain_offset + i,
                                patch.width,
                                along_x.data(),
                                {static_cast<float>(by[0]), static_cast<float>(by[1]), static_cast<float>(by[2])},
                                static_cast<float>(light.gain),
                                patch.template_share,
                                (1 - patch.template_share) * 0.5F / patch.step};
          jacobian_segment(segment, n, filled, J);
          filled += n;
        }
      }
      flush();
      scatter(sums, cx, cy, columns, equations);
    }
}

}  // namespace heartservo::tracking
