#include "tracking/planar/quad.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace heartservo::tracking {

namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// The similarity that brings the corners around the origin at a distance of about 1: keeps the 8 x 8 system well
// conditioned whether the corners come in px or in metres.
Eigen::Matrix3d normalisation(const Quad& quad) {
  const Eigen::Vector2d middle = centre(quad);
  double distance = 0;
  for (const auto& corner : quad) distance += (corner - middle).norm() / 4;
  Eigen::Matrix3d T;
  T << 1 / distance, 0, -middle.x() / distance, 0, 1 / distance, -middle.y() / distance, 0, 0, 1;
  return T;
}

}  // namespace

double area(const Quad& quad) { return cross(quad[2] - quad[0], quad[3] - quad[1]) / 2; }

bool is_convex(const Quad& quad) {
  for (std::size_t i = 0; i < 4; ++i) {
    const auto &before = quad[(i + 3) % 4], &here = quad[i], &after = quad[(i + 1) % 4];
    if (!(cross(here - before, after - here) > 0)) return false;  // false for NaN too
  }
  return quad[0].allFinite() && quad[1].allFinite() && quad[2].allFinite() && quad[3].allFinite();
}

Eigen::Matrix3d homography_between(const Quad& from, const Quad& to) {
  const Eigen::Matrix3d T_from = normalisation(from), T_to = normalisation(to);
  const Quad a = transform(T_from, from), b = transform(T_to, to);
  // u (h7 x + h8 y + 1) = h1 x + h2 y + h3 and the same for v. The lower right element may be set to 1 here because
  // the middle of a convex quad, the origin, does not go to infinity.
  Eigen::Matrix<double, 8, 8> A = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> right;
  for (int i = 0; i < 4; ++i) {
    const double x = a[i].x(), y = a[i].y(), u = b[i].x(), v = b[i].y();
    A.row(2 * i) << x, y, 1, 0, 0, 0, -u * x, -u * y;
    A.row(2 * i + 1) << 0, 0, 0, x, y, 1, -v * x, -v * y;
    right.segment<2>(2 * i) = b[i];
  }
  const Eigen::Matrix<double, 8, 1> h = A.partialPivLu().solve(right);
  Eigen::Matrix3d H;
  H << h(0), h(1), h(2), h(3), h(4), h(5), h(6), h(7), 1;
  H = T_to.inverse() * H * T_from;
  return H / H(2, 2);
}

Quad transform(const Eigen::Matrix3d& H, const Quad& quad) {
  Quad result;
  for (std::size_t i = 0; i < 4; ++i) result[i] = (H * quad[i].homogeneous()).hnormalized();
  return result;
}

ViewChange view_change(const Quad& reference, const Quad& current) {
  ViewChange change;
  change.scale = std::sqrt(std::abs(area(current) / area(reference)));
  // The affine part, from the two mid-lines of each quad.
  const auto axes = [](const Quad& q) {
    Eigen::Matrix2d M;
    M << (q[1] + q[2] - q[0] - q[3]) / 2, (q[2] + q[3] - q[0] - q[1]) / 2;
    return M;
  };
  const Eigen::Matrix2d A = axes(current) * axes(reference).inverse();
  const Eigen::Matrix2d AtA = A.transpose() * A;
  const double mean = AtA.trace() / 2, spread = std::sqrt(std::max(0.0, mean * mean - AtA.determinant()));
  change.anisotropy = std::sqrt((mean + spread) / std::max(1e-12, mean - spread));
  for (std::size_t i = 0; i < 2; ++i) {
    const auto side = [i](const Quad& q, std::size_t k) { return (q[(i + k + 1) % 4] - q[(i + k) % 4]).norm(); };
    const double ratio = side(current, 0) / side(reference, 0) * side(reference, 2) / side(current, 2);
    change.perspective = std::max({change.perspective, ratio, 1 / ratio});
  }
  return change;
}

}  // namespace heartservo::tracking
