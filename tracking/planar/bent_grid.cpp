#include "tracking/planar/bent_grid.hpp"

#include <algorithm>
#include <array>

#include "tracking/planar/simd/bend_kernel.hpp"
#include "tracking/planar/simd/esm_kernel.hpp"
#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

namespace {

// Three control points of the splines along x, and these splines, over the columns of a cell.
struct Segment {
  const float *b0, *b1, *b2;
  const Eigen::Vector3f* p;
  std::size_t n;
};

HEARTSERVO_SIMD void bend_segment(const Segment& s, const float* __restrict rest_x, float rest_y, float* __restrict x,
                                  float* __restrict y, float* __restrict gain) {
  const float x0 = s.p[0].x(), x1 = s.p[1].x(), x2 = s.p[2].x(), y0 = s.p[0].y(), y1 = s.p[1].y(), y2 = s.p[2].y(),
              g0 = s.p[0].z(), g1 = s.p[1].z(), g2 = s.p[2].z();
#pragma omp simd
  for (std::size_t i = 0; i < s.n; ++i) {
    const float b0 = s.b0[i], b1 = s.b1[i], b2 = s.b2[i];
    x[i] = rest_x[i] + (b0 * x0 + b1 * x1 + b2 * x2);
    y[i] = rest_y + (b0 * y0 + b1 * y1 + b2 * y2);
    gain[i] = b0 * g0 + b1 * g1 + b2 * g2;
  }
}

}  // namespace

SplineBend bend_of(int side_x, int side_y, double cell_px) {
  const double half_px = 0.5 * std::max(side_x, side_y);
  return SplineBend(0.5 * side_x / half_px, 0.5 * side_y / half_px, cell_px / half_px);
}

BentGrid::BentGrid(const SplineBend& bend, const Patch& patch)
    : bend_(bend),
      x_(patch.size()),
      y_(patch.size()),
      gain_offset_(patch.size() + simd::kEsmPad),
      stride_(patch.width + simd::kMostLanes) {
  along_x_.assign(static_cast<std::size_t>(3 * stride_), 0);
  for (int i = 0; i < patch.width; ++i) {
    rest_x_.push_back(patch.x_of(i));
    columns_.push_back(bend.along_x(static_cast<double>(rest_x_.back())));
    for (int k = 0; k < 3; ++k)
      along_x_[static_cast<std::size_t>(k * stride_ + i)] =
          static_cast<float>(columns_.back().value[static_cast<std::size_t>(k)]);
    cell_end_.resize(static_cast<std::size_t>(columns_.back().first) + 1, i);
    cell_end_.back() = i + 1;
  }
  for (int i = 0; i < patch.height; ++i) {
    rest_y_.push_back(patch.y_of(i));
    rows_.push_back(bend.along_y(static_cast<double>(rest_y_.back())));
    for (const double value : rows_.back().value) along_y_.push_back(static_cast<float>(value));
  }
}

BentPoints BentGrid::bend(const BendField& field) {
  const int width = bend_.columns();
  std::array<Eigen::Vector3f, kMaxBendPoints> line;  // control points of the splines along x, at the row's y
  const Eigen::Matrix<float, 3, Eigen::Dynamic, 0, 3, kMaxBendPoints> points = field.cast<float>();
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const int first = rows_[row].first;
    const float* b = along_y(static_cast<int>(row));
    for (int k = 0; k < width; ++k)
      line[static_cast<std::size_t>(k)] = b[0] * points.col(first * width + k) +
                                          b[1] * points.col((first + 1) * width + k) +
                                          b[2] * points.col((first + 2) * width + k);
    int begin = 0;
    for (std::size_t cell = 0; cell < cell_end_.size(); ++cell) {
      const int end = cell_end_[cell];
      const float* splines = along_x(begin);
      const std::size_t at = row * columns_.size() + static_cast<std::size_t>(begin);
      bend_segment({splines, splines + stride_, splines + 2 * stride_, &line[cell], static_cast<std::size_t>(end - begin)},
                   &rest_x_[static_cast<std::size_t>(begin)], rest_y_[row], &x_[at], &y_[at], &gain_offset_[at]);
      begin = end;
    }
  }
  return {x_.data(), y_.data(), gain_offset_.data()};
}

}  // namespace heartservo::tracking
