#include "tracking/landmark/square_pose.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>

#include "tracking/planar/quad.hpp"

namespace heartservo::tracking {

Eigen::Isometry3d linear_square_pose(const std::array<Eigen::Vector2d, 4>& normalised_corners, double side_m) {
  // The centre of the square, where H's third row is its lower right element 1, lies before the camera: s > 0 is right.
  const Quad square = rectangle(-side_m / 2, -side_m / 2, side_m, side_m);
  const Eigen::Matrix3d H = homography_between(square, normalised_corners);
  const double s = 1 / (0.5 * (H.col(0).norm() + H.col(1).norm()));
  Eigen::Matrix3d R;
  R.col(0) = s * H.col(0);
  R.col(1) = s * H.col(1);
  R.col(2) = R.col(0).cross(R.col(1));

  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();
  T_camera_target.translation() = s * H.col(2);
  if (!R.allFinite()) {
    T_camera_target.linear() = R;
    return T_camera_target;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double handedness = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  T_camera_target.linear() = svd.matrixU() * Eigen::Vector3d(1, 1, handedness).asDiagonal() * svd.matrixV().transpose();
  return T_camera_target;
}

}  // namespace heartservo::tracking
