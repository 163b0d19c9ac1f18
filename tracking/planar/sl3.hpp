#pragma once
// The Lie group SL(3) of homographies with determinant 1 (Benhimane & Malis 2004), parametrised by eight numbers in
// the order: shift x, shift y, shear x, shear y, stretch, scale, perspective x, perspective y. The first two alone are
// translations, the first six affine maps.
#include <Eigen/Core>

namespace heartservo::tracking {

using Vector8d = Eigen::Matrix<double, 8, 1>;

/// The element of the Lie algebra sl(3) (trace 0) with the given coordinates.
inline Eigen::Matrix3d sl3_algebra(const Vector8d& d) {
  Eigen::Matrix3d A;
  A << d[4] + d[5] / 3, d[2], d[0],  //
      d[3], -d[4] + d[5] / 3, d[1],  //
      d[6], d[7], -2 * d[5] / 3;
  return A;
}

/// exp of the algebra element: a homography of determinant 1.
Eigen::Matrix3d sl3_exp(const Vector8d& d);

/// H scaled to determinant 1 (its determinant must be positive).
Eigen::Matrix3d to_sl3(const Eigen::Matrix3d& H);

/// d (x, y) / d d at d = 0 for the point (x, y) moved by sl3_exp(d): 2 x 8.
Eigen::Matrix<double, 2, 8> sl3_point_jacobian(double x, double y);

}  // namespace heartservo::tracking
