#include "tracking/camera/calibration/plane_homography.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace heartservo::tracking {

namespace {

// Moves the points to their centre and scales them to a mean distance of sqrt 2 (Hartley).
Eigen::Matrix3d conditioner(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const auto& p : points) centre += p / static_cast<double>(points.size());
  double distance = 0;
  for (const auto& p : points) distance += (p - centre).norm() / static_cast<double>(points.size());
  const double s = std::sqrt(2.0) / distance;
  Eigen::Matrix3d T;
  T << s, 0, -s * centre.x(), 0, s, -s * centre.y(), 0, 0, 1;
  return T;
}

}  // namespace

std::optional<Eigen::Matrix3d> plane_homography(const std::vector<Eigen::Vector3d>& points, const Corners& images) {
  if (points.size() != images.size() || points.size() < 4) return std::nullopt;
  std::vector<Eigen::Vector2d> plane;
  for (const auto& p : points) plane.push_back(p.head<2>());
  const Eigen::Matrix3d T_plane = conditioner(plane), T_image = conditioner(images);
  if (!T_plane.allFinite() || !T_image.allFinite()) return std::nullopt;
  Eigen::Matrix<double, 9, 9> A = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = T_plane * plane[i].homogeneous();
    const Eigen::Vector2d q = (T_image * images[i].homogeneous()).head<2>();
    Eigen::Matrix<double, 2, 9> rows;
    rows << p.transpose(), Eigen::RowVector3d::Zero(), -q.x() * p.transpose(), Eigen::RowVector3d::Zero(),
        p.transpose(), -q.y() * p.transpose();
    A += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(A);
  if (eigen.info() != Eigen::Success || !(eigen.eigenvalues()[1] > 1e-9 * eigen.eigenvalues()[8])) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = eigen.eigenvectors().col(0);
  const Eigen::Matrix3d H = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data());
  const Eigen::Matrix3d result = T_image.inverse() * H * T_plane;
  return result.allFinite() ? std::optional(result) : std::nullopt;
}

std::optional<double> focal_length(const std::vector<Eigen::Matrix3d>& homographies, int width, int height) {
  // With the principal point at the origin, h1' w h2 = 0 and h1' w h1 = h2' w h2 for w = diag(1, 1, f^2) / f^2: two
  // equations a x + b = 0 a view, for x = 1 / f^2.
  double ab = 0, aa = 0;
  for (const auto& H_view : homographies) {
    Eigen::Matrix3d H = H_view;
    H.row(0) -= 0.5 * (width - 1) * H.row(2);
    H.row(1) -= 0.5 * (height - 1) * H.row(2);
    const Eigen::Vector3d h1 = H.col(0), h2 = H.col(1);
    const double weight = 1 / (h1.head<2>().squaredNorm() + h2.head<2>().squaredNorm());
    const auto add = [&](double a, double b) {
      aa += weight * weight * a * a;
      ab += weight * weight * a * b;
    };
    add(h1.head<2>().dot(h2.head<2>()), h1.z() * h2.z());
    add(h1.head<2>().squaredNorm() - h2.head<2>().squaredNorm(), h1.z() * h1.z() - h2.z() * h2.z());
  }
  const double f = std::sqrt(-aa / ab);
  const double size = std::max(width, height);
  if (!(f > 0.1 * size && f < 20 * size)) return std::nullopt;  // NaN too
  return f;
}

std::optional<Eigen::Isometry3d> plane_pose(const Camera& camera, const std::vector<Eigen::Vector3d>& points,
                                            const Corners& images) {
  Corners normalised;
  for (const auto& pixel : images) {
    normalised.push_back(camera.normalise(pixel));
    if (!normalised.back().allFinite()) return std::nullopt;
  }
  const auto found = plane_homography(points, normalised);
  if (!found) return std::nullopt;
  Eigen::Matrix3d H = *found * (2 / (found->col(0).norm() + found->col(1).norm()));  // eq. 8
  if (H(2, 2) < 0) H = -H;
  Eigen::Matrix3d R;
  R << H.col(0), H.col(1), H.col(0).cross(H.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = svd.matrixU() * svd.matrixV().transpose();
  T.translation() = H.col(2);
  if (!T.matrix().allFinite() || T.linear().determinant() < 0) return std::nullopt;
  return T;
}

}  // namespace heartservo::tracking
