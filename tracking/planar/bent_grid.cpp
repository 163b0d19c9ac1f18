#include "tracking/planar/bent_grid.hpp"

#include <algorithm>

namespace heartservo::tracking {

SplineBend bend_of(int side_x, int side_y, double cell_px) {
  const double half_px = 0.5 * std::max(side_x, side_y);
  return SplineBend(0.5 * side_x / half_px, 0.5 * side_y / half_px, cell_px / half_px);
}

BentGrid::BentGrid(const SplineBend& bend, const Patch& patch)
    : bend_(bend), x_(patch.size()), y_(patch.size()), gain_offset_(patch.size()) {
  for (int i = 0; i < patch.width; ++i) {
    rest_x_.push_back(patch.x_of(i));
    columns_.push_back(bend.along_x(static_cast<double>(rest_x_.back())));
  }
  for (int i = 0; i < patch.height; ++i) {
    rest_y_.push_back(patch.y_of(i));
    rows_.push_back(bend.along_y(static_cast<double>(rest_y_.back())));
  }
}

BentPoints BentGrid::bend(const BendField& field) {
  const int width = bend_.columns();
  std::array<Eigen::Vector3f, kMaxBendPoints> line;  // control points of the splines along x, at the row's y
  std::size_t i = 0;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const auto& b = rows_[row];
    for (int k = 0; k < width; ++k) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int j = 0; j < 3; ++j) sum += b.value[static_cast<std::size_t>(j)] * field.col((b.first + j) * width + k);
      line[static_cast<std::size_t>(k)] = sum.cast<float>();
    }
    for (std::size_t column = 0; column < columns_.size(); ++column, ++i) {
      const auto& c = columns_[column];
      const Eigen::Vector3f* p = &line[static_cast<std::size_t>(c.first)];
      const Eigen::Vector3f u = static_cast<float>(c.value[0]) * p[0] + static_cast<float>(c.value[1]) * p[1] +
                                static_cast<float>(c.value[2]) * p[2];
      x_[i] = rest_x_[column] + u.x();
      y_[i] = rest_y_[row] + u.y();
      gain_offset_[i] = u.z();
    }
  }
  return {x_.data(), y_.data(), gain_offset_.data()};
}

}  // namespace heartservo::tracking
