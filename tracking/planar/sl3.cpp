#include "tracking/planar/sl3.hpp"

#include <Eigen/LU>
#include <cmath>

namespace heartservo::tracking {

Eigen::Matrix3d sl3_exp(const Vector8d& d) {
  // Scaling and squaring with a Taylor series: after halving to a norm below 1/8 ten terms reach double precision.
  Eigen::Matrix3d A = sl3_algebra(d);
  const double norm = A.norm();
  int squarings = 0;
  if (!std::isfinite(norm)) return Eigen::Matrix3d::Constant(NAN);
  for (double n = norm; n > 0.125 && squarings < 60; n /= 2) ++squarings;
  A /= std::exp2(squarings);
  Eigen::Matrix3d result = Eigen::Matrix3d::Identity(), term = Eigen::Matrix3d::Identity();
  for (int k = 1; k <= 10; ++k) {
    term = term * A / k;
    result += term;
  }
  for (int i = 0; i < squarings; ++i) result = (result * result).eval();
  return result;
}

Eigen::Matrix3d to_sl3(const Eigen::Matrix3d& H) { return H / std::cbrt(H.determinant()); }

Eigen::Matrix<double, 2, 8> sl3_point_jacobian(double x, double y) {
  Eigen::Matrix<double, 2, 8> J;
  J << 1, 0, y, 0, x, x, -x * x, -x * y,  //
      0, 1, 0, x, -y, y, -x * y, -y * y;
  return J;
}

}  // namespace heartservo::tracking
