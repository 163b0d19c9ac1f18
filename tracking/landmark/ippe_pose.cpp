#include "tracking/landmark/ippe_pose.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "tracking/landmark/square_pose.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::tracking {

namespace {

// The rotation that takes the optical axis to the direction of (v, 1).
Eigen::Matrix3d axis_towards(const Eigen::Vector2d& v) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  const double t2 = v.squaredNorm();
  if (!(t2 > 0)) return R;
  const double cosine = 1 / std::sqrt(1 + t2), share = (1 - cosine) / t2;
  R.topLeftCorner<2, 2>() -= share * v * v.transpose();
  R.topRightCorner<2, 1>() = cosine * v;
  R.bottomLeftCorner<1, 2>() = -cosine * v.transpose();
  R(2, 2) = cosine;
  return R;
}

// Where the square of side 1 lies when it is turned so: least squares of the corners' collinearity.
Eigen::Vector3d translation_of(const Eigen::Matrix3d& R, const std::array<Eigen::Vector2d, 4>& corners) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d& q = corners[static_cast<std::size_t>(i)];
    Eigen::Matrix<double, 2, 3> J;
    J << 1, 0, -q.x(), 0, 1, -q.y();
    A += J.transpose() * J;
    b -= J.transpose() * (J * (R * square_corner(i, 1)));
  }
  return A.ldlt().solve(b);
}

double squared_error(const Eigen::Isometry3d& T, const std::array<Eigen::Vector2d, 4>& corners) {
  double sum = 0;
  for (int i = 0; i < 4; ++i)
    sum += ((T * square_corner(i, 1)).hnormalized() - corners[static_cast<std::size_t>(i)]).squaredNorm();
  return sum;
}

}  // namespace

bool ippe_square_poses(const std::array<Eigen::Vector2d, 4>& normalised_corners, double side_m,
                       std::array<Eigen::Isometry3d, 2>& T_camera_target) {
  for (const auto& corner : normalised_corners)
    if (!corner.allFinite()) return false;
  const Eigen::Matrix3d H = homography_between(rectangle(-0.5, -0.5, 1, 1), normalised_corners);
  if (!H.allFinite()) return false;
  // how the plane's centre moves in the picture, seen along the ray to it
  const Eigen::Vector2d v = H.topRightCorner<2, 1>() / H(2, 2);
  const Eigen::Matrix2d J = (H.topLeftCorner<2, 2>() - v * H.bottomLeftCorner<1, 2>()) / H(2, 2);
  const Eigen::Matrix3d R_v = axis_towards(v);
  const Eigen::Matrix2d B = R_v.topLeftCorner<2, 2>() - v * R_v.bottomLeftCorner<1, 2>();
  const Eigen::Matrix2d A = B.inverse() * J, AAt = A * A.transpose();
  const double difference = AAt(0, 0) - AAt(1, 1);
  const double gamma2 =
      0.5 * (AAt.trace() + std::sqrt(difference * difference + 4 * AAt(0, 1) * AAt(0, 1)));  // largest singular value
  if (!(gamma2 > 0) || !std::isfinite(gamma2)) return false;
  const Eigen::Matrix2d R = A / std::sqrt(gamma2);
  // the third components of the first two columns, which have length 1 and stand at right angles
  const Eigen::Matrix2d rest = Eigen::Matrix2d::Identity() - R.transpose() * R;
  Eigen::Vector2d b(std::sqrt(std::max(0.0, rest(0, 0))), std::sqrt(std::max(0.0, rest(1, 1))));
  if (rest(0, 1) < 0) b.y() = -b.y();
  for (int i = 0; i < 2; ++i) {
    Eigen::Matrix3d local;
    local.topLeftCorner<2, 2>() = R;
    local.bottomLeftCorner<1, 2>() = (i == 0 ? 1 : -1) * b.transpose();
    local.col(2) = local.col(0).cross(local.col(1));
    auto& T = T_camera_target[static_cast<std::size_t>(i)];
    T.setIdentity();
    T.linear() = R_v * local;
    T.translation() = translation_of(T.linear(), normalised_corners);
    if (!T.matrix().allFinite()) return false;
  }
  if (squared_error(T_camera_target[1], normalised_corners) < squared_error(T_camera_target[0], normalised_corners))
    std::swap(T_camera_target[0], T_camera_target[1]);
  for (auto& T : T_camera_target) T.translation() *= side_m;
  return true;
}

}  // namespace heartservo::tracking
