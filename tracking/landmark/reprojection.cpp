#include "tracking/landmark/reprojection.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "tracking/landmark/square_pose.hpp"

namespace heartservo::tracking {

namespace {

constexpr int MAX_ITERATIONS = 50;
constexpr double kSmallestStep = 1e-11;  // of the distance, and rad
constexpr double kRounding = 1e-7;       // the residual does not tell steps this small apart

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d S;
  S << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return S;
}

// Measured minus predicted corners; not finite behind the camera.
Vector8d residual(const Camera& camera, const Eigen::Isometry3d& T_camera_target, double side_m, const Quad& corners) {
  Vector8d e;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d point = T_camera_target * square_corner(i, side_m);
    if (!(point.z() > 0)) return Vector8d::Constant(std::numeric_limits<double>::quiet_NaN());
    e.segment<2>(2 * i) = corners[i] - camera.project(point);
  }
  return e;
}

}  // namespace

Quad project_square(const Camera& camera, const Eigen::Isometry3d& T_camera_target, double side_m) {
  Quad corners;
  for (int i = 0; i < 4; ++i) corners[i] = camera.project(T_camera_target * square_corner(i, side_m));
  return corners;
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& T, const Eigen::Matrix<double, 6, 1>& twist) {
  Eigen::Isometry3d result = T;
  result.translation() += twist.head<3>();
  const double angle = twist.tail<3>().norm();
  if (angle > 0) result.linear() = Eigen::AngleAxisd(angle, twist.tail<3>() / angle) * T.linear();
  return result;
}

Jacobian8x6 square_jacobian(const Camera& camera, const Eigen::Isometry3d& T_camera_target, double side_m) {
  Jacobian8x6 J;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d arm = T_camera_target.linear() * square_corner(i, side_m);
    const Eigen::Vector3d p = T_camera_target.translation() + arm;
    Eigen::Matrix<double, 2, 3> J_normalise;  // d (x/z, y/z) / d p
    J_normalise << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
    const Eigen::Matrix2d J_lens = camera.distort_jacobian(p.hnormalized());
    const Eigen::Matrix<double, 2, 3> J_point =
        Eigen::Vector2d(camera.fx, camera.fy).asDiagonal() * J_lens * J_normalise;
    J.block<2, 3>(2 * i, 0) = J_point;
    J.block<2, 3>(2 * i, 3) = -J_point * skew(arm);  // d (w x arm) = -[arm]x dw
  }
  return J;
}

double reprojection_rms_px(const Camera& camera, const Eigen::Isometry3d& T_camera_target, double side_m,
                           const Quad& corners) {
  return std::sqrt(residual(camera, T_camera_target, side_m, corners).squaredNorm() / 4);
}

Eigen::Isometry3d refine_pose(const Camera& camera, const Eigen::Isometry3d& start, double side_m,
                              const Quad& corners) {
  Eigen::Isometry3d T = start;
  Vector8d e = residual(camera, T, side_m, corners);
  double lambda = 1e-4;
  for (int iteration = 0; iteration < MAX_ITERATIONS && e.allFinite(); ++iteration) {
    const Jacobian8x6 J = square_jacobian(camera, T, side_m);
    Matrix6d A = J.transpose() * J;
    A.diagonal() *= 1 + lambda;  // Marquardt's scaling: metres and radians differ by orders of magnitude
    const Eigen::Matrix<double, 6, 1> step = A.ldlt().solve(J.transpose() * e);
    if (!step.allFinite()) break;
    const Eigen::Isometry3d T_next = moved(T, step);
    const Vector8d e_next = residual(camera, T_next, side_m, corners);
    const bool better = e_next.squaredNorm() < e.squaredNorm();
    if (better) {
      T = T_next;
      e = e_next;
      lambda = std::max(lambda * 0.1, 1e-12);
    } else {
      lambda *= 10;
    }
    const double size = std::max(step.head<3>().norm() / T.translation().norm(), step.tail<3>().norm());
    if (size < kSmallestStep || (!better && size < kRounding) || lambda > 1e8) break;
  }
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return T;
}

Matrix6d pose_covariance(const Camera& camera, const Eigen::Isometry3d& T_camera_target, double side_m,
                         double corner_sigma_px) {
  const Jacobian8x6 J = square_jacobian(camera, T_camera_target, side_m);
  // Inverted in units of about one pixel for every column, which keeps metres and radians from spoiling the condition.
  const Eigen::Matrix<double, 6, 1> scale = J.colwise().norm().cwiseInverse();
  const Jacobian8x6 J_scaled = J * scale.asDiagonal();
  const Matrix6d inverse = (J_scaled.transpose() * J_scaled).ldlt().solve(Matrix6d::Identity());
  return scale.asDiagonal() * inverse * scale.asDiagonal() * (corner_sigma_px * corner_sigma_px);
}

}  // namespace heartservo::tracking
