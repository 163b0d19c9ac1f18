#include "sim/endoscope/node_grid.hpp"

#include <array>
#include <cmath>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::sim {
namespace {

constexpr int kStep = NodeGrid::kNodeStep;

/// Lagrange's cubic weights of the nodes -1, 0, 1, 2 at the fractions 0, 1/step, ...
struct CubicWeights {
  float at[4][kStep];
  constexpr CubicWeights() : at{} {
    for (int i = 0; i < kStep; ++i) {
      const double f = static_cast<double>(i) / kStep;
      at[0][i] = static_cast<float>(-f * (f - 1) * (f - 2) / 6);
      at[1][i] = static_cast<float>((f + 1) * (f - 1) * (f - 2) / 2);
      at[2][i] = static_cast<float>(-(f + 1) * f * (f - 2) / 2);
      at[3][i] = static_cast<float>((f + 1) * f * (f - 1) / 6);
    }
  }
};
constexpr CubicWeights kWeights;

HEARTSERVO_SIMD
void combine_rows(const float* nodes, int columns, float w0, float w1, float w2, float w3, float* out) {
  const float *r0 = nodes, *r1 = r0 + columns, *r2 = r1 + columns, *r3 = r2 + columns;
  for (int i = 0; i < columns; ++i) out[i] = w0 * r0[i] + w1 * r1[i] + w2 * r2[i] + w3 * r3[i];
}

HEARTSERVO_SIMD
void spread_columns(const float* nodes, int cells, float* __restrict out) {
  for (int i = 0; i < cells; ++i) {
    const float a = nodes[i], b = nodes[i + 1], c = nodes[i + 2], d = nodes[i + 3];
    for (int k = 0; k < kStep; ++k)
      out[i * kStep + k] =
          a * kWeights.at[0][k] + b * kWeights.at[1][k] + c * kWeights.at[2][k] + d * kWeights.at[3][k];
  }
}

/// Continues the four values at p, p + d, p + 2 d, p + 3 d by one before p, as their cubic polynomial does.
double continued(const double* p, std::ptrdiff_t d) { return 4 * p[0] - 6 * p[d] + 4 * p[2 * d] - p[3 * d]; }

}  // namespace

NodeGrid::NodeGrid(int width, int height)
    : width_(width),
      height_(height),
      columns_((width + kStep - 1) / kStep + 3),
      rows_((height + kStep - 1) / kStep + 3) {}

void NodeGrid::interpolate_row(const float* nodes, int channels, int v, float* scratch, float* out) const {
  const int row = v / kStep, fraction = v % kStep;
  for (int c = 0; c < channels; ++c) {
    combine_rows(nodes + static_cast<std::ptrdiff_t>(c) * size() + static_cast<std::ptrdiff_t>(row) * columns_,
                 columns_, kWeights.at[0][fraction], kWeights.at[1][fraction], kWeights.at[2][fraction],
                 kWeights.at[3][fraction], scratch);
    spread_columns(scratch, columns_ - 3, out + static_cast<std::ptrdiff_t>(c) * padded_width());
  }
}

std::vector<double> node_rays(const tracking::Camera& camera, const NodeGrid& grid) {
  const int columns = grid.columns(), rows = grid.rows();
  std::vector<double> rays(2 * static_cast<std::size_t>(grid.size()));
  double* x = rays.data();
  double* y = x + grid.size();
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const Eigen::Vector2d ray = camera.normalise({grid.u_px(i), grid.v_px(j)});
      x[j * columns + i] = ray.x(), y[j * columns + i] = ray.y();
    }
  // Inside out: each node without a ray from the four before it, first along rows, then along columns.
  for (double* plane : {x, y}) {
    for (int j = 1; j + 2 < rows; ++j) {
      double* row = plane + static_cast<std::ptrdiff_t>(j) * columns;
      if (!std::isfinite(row[0])) row[0] = continued(row + 1, 1);
      for (int i = columns - 2; i < columns; ++i)
        if (!std::isfinite(row[i])) row[i] = continued(row + i - 1, -1);
    }
    for (int i = 0; i < columns; ++i) {
      double* column = plane + i;
      if (!std::isfinite(column[0])) column[0] = continued(column + columns, columns);
      for (int j = rows - 2; j < rows; ++j)
        if (!std::isfinite(column[j * columns]))
          column[j * columns] = continued(column + static_cast<std::ptrdiff_t>(j - 1) * columns, -columns);
    }
  }
  return rays;
}

}  // namespace heartservo::sim
