#include "tracking/planar/spline_bend.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace heartservo::tracking {

SplineBend::SplineBend(double half_x, double half_y, double cell) : half_x_(half_x), half_y_(half_y) {
  const auto cells = [&](double half) { return std::max(1, static_cast<int>(std::lround(2 * half / cell))); };
  cells_x_ = cells(half_x);
  cells_y_ = cells(half_y);
  while (points() > kMaxBendPoints) --(cells_x_ >= cells_y_ ? cells_x_ : cells_y_);
}

SplineBend::Basis SplineBend::basis(double x, double half, int cells) {
  const double t = (x + half) / (2 * half) * cells;
  Basis b;
  b.first = std::clamp(static_cast<int>(std::floor(t)), 0, cells - 1);
  const double s = t - b.first;
  b.value = {0.5 * (1 - s) * (1 - s), 0.5 + s * (1 - s), 0.5 * s * s};
  return b;
}

Eigen::Vector2d SplineBend::offset(const BendField& field, const Eigen::Vector2d& at) const {
  const Basis bx = along_x(at.x()), by = along_y(at.y());
  Eigen::Vector2d u = Eigen::Vector2d::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      u += by.value[static_cast<std::size_t>(i)] * bx.value[static_cast<std::size_t>(j)] *
           field.col((by.first + i) * columns() + bx.first + j).head<2>();
  return u;
}

double SplineBend::gain_offset(const BendField& field, const Eigen::Vector2d& at) const {
  const Basis bx = along_x(at.x()), by = along_y(at.y());
  double gain = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      gain += by.value[static_cast<std::size_t>(i)] * bx.value[static_cast<std::size_t>(j)] *
              field(2, (by.first + i) * columns() + bx.first + j);
  return gain;
}

Eigen::Matrix3d SplineBend::split_homography(BendField& field) const {
  if (field.cols() == 0) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d H = split_once(field);
  return H * split_once(field);  // the first fit has the perspective in the axes before the affine map
}

Eigen::Matrix3d SplineBend::split_once(BendField& field) const {
  Eigen::Matrix3d H = Eigen::Matrix3d::Identity();
  const Eigen::Vector2d shift = offset(field, Eigen::Vector2d::Zero());
  // Control points of D x - (p . x) x, unknown D (2 x 2, by rows) and p. Those of x^2 are x_k^2 - cell^2 / 4.
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  const auto rows_of = [this](const Eigen::Vector2d& r) {
    const double xx = r.x() * r.x() - 0.25 * cell_x() * cell_x(), yy = r.y() * r.y() - 0.25 * cell_y() * cell_y();
    const double xy = r.x() * r.y();
    Eigen::Matrix<double, 2, 6> J;
    J << r.x(), r.y(), 0, 0, -xx, -xy, 0, 0, r.x(), r.y(), -xy, -yy;
    return J;
  };
  for (int row = 0; row < rows(); ++row)
    for (int column = 0; column < columns(); ++column) {
      const Eigen::Vector2d r = rest(column, row);
      const double weight = std::exp(-2 * r.squaredNorm());  // Gaussian of sigma 1/2
      const Eigen::Matrix<double, 2, 6> J = rows_of(r);
      A += weight * J.transpose() * J;
      b += weight * J.transpose() * (field.col(row * columns() + column).head<2>() - shift);
    }
  A.diagonal() *= 1 + 1e-12;
  const Eigen::Matrix<double, 6, 1> fit = A.ldlt().solve(b);
  Eigen::Matrix2d linear;
  linear << 1 + fit(0), fit(1), fit(2), 1 + fit(3);
  const Eigen::Matrix2d inverse = linear.inverse();
  const Eigen::Vector2d p = inverse.transpose() * Eigen::Vector2d(fit(4), fit(5));
  Eigen::Matrix<double, 6, 1> perspective = Eigen::Matrix<double, 6, 1>::Zero();
  perspective.tail<2>() = p;
  for (int row = 0; row < rows(); ++row)
    for (int column = 0; column < columns(); ++column) {
      const Eigen::Vector2d r = rest(column, row);
      auto c = field.col(row * columns() + column).head<2>();
      c = (inverse * (r + c - shift) - r - rows_of(r) * perspective).eval();
    }
  H.topLeftCorner<2, 2>() = linear;
  H.topRightCorner<2, 1>() = shift;
  Eigen::Matrix3d P = Eigen::Matrix3d::Identity();
  P.bottomLeftCorner<1, 2>() = p.transpose();
  return H * P;
}

std::vector<SplineBend::Difference> SplineBend::differences() const {
  const int w = columns(), h = rows();
  std::vector<Difference> all;
  for (int row = 0; row < h; ++row)
    for (int column = 0; column < w; ++column) {
      const int k = row * w + column;
      if (column > 0 && column + 1 < w) all.push_back({{k - 1, k, k + 1, k}, {1, -2, 1, 0}});
      if (row > 0 && row + 1 < h) all.push_back({{k - w, k, k + w, k}, {1, -2, 1, 0}});
      const double twice = std::sqrt(2.0);  // the mixed derivative counts twice in the bending energy
      if (column + 1 < w && row + 1 < h) all.push_back({{k, k + 1, k + w, k + w + 1}, {twice, -twice, -twice, twice}});
    }
  return all;
}

}  // namespace heartservo::tracking
