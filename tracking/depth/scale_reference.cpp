#include "tracking/depth/scale_reference.hpp"

#include <fmt/format.h>

#include <cmath>

namespace heartservo::tracking {

namespace {

constexpr double kLargestRelativeSigma = 0.5;  // beyond it a distance says nothing

// z where the ray (n, 1) meets the plane through `p` with normal `normal`.
double depth_on(const Eigen::Vector3d& p, const Eigen::Vector3d& normal, const Eigen::Vector2d& n) {
  return normal.dot(p) / normal.dot(n.homogeneous());
}

}  // namespace

std::vector<std::string> ScaleReference::validate() const {
  std::vector<std::string> problems;
  if (!(depth_m > 0) || !std::isfinite(depth_m))
    problems.push_back(fmt::format("the distance of the region is {} m; must be positive", depth_m));
  else if (!(sigma_m > 0 && sigma_m <= kLargestRelativeSigma * depth_m))
    problems.push_back(
        fmt::format("the distance's standard deviation is {} m; must be positive and at most half of the distance of "
                    "{} m",
                    sigma_m, depth_m));
  if (!slope.allFinite() || slope.norm() > 3)
    problems.push_back(fmt::format("the region's plane has slopes ({}, {}): seen from its edge", slope.x(), slope.y()));
  if (!(slope_sigma > 0) || !std::isfinite(slope_sigma))
    problems.push_back(fmt::format("the standard deviation of the slopes is {}; must be positive", slope_sigma));
  return problems;
}

ScaleReference scale_from_landmark(const Camera& camera, const TargetState& landmark,
                                   const Eigen::Matrix<double, 6, 6>& twist_covariance,
                                   const Eigen::Vector2d& centre_px, double roughness_m) {
  ScaleReference scale;
  const Eigen::Vector2d n = camera.normalise(centre_px);
  if (landmark.state == TrackState::LOST || !n.allFinite()) return scale;
  const Eigen::Vector3d p = landmark.T_camera_target.translation(), normal = landmark.T_camera_target.linear().col(2);
  if (std::abs(normal.z()) < 0.1) return scale;
  scale.depth_m = depth_on(p, normal, n);
  scale.slope = -normal.head<2>() / normal.z();
  // d depth / d twist: with q the point met, normal . (p + v - s ray) = 0 and normal turned by w.
  const Eigen::Vector3d ray = n.homogeneous(), q = scale.depth_m * ray;
  Eigen::Matrix<double, 1, 6> J;
  J << normal.transpose(), normal.cross(p - q).transpose();
  J /= normal.dot(ray);
  scale.sigma_m = std::sqrt((J * twist_covariance * J.transpose())(0) + roughness_m * roughness_m);
  const double tilt = std::sqrt(twist_covariance.block<2, 2>(3, 3).trace() / 2);
  const double distance = std::max((q - p).norm(), 1e-3);
  scale.slope_sigma = std::hypot(tilt / (normal.z() * normal.z()), roughness_m / distance);
  return scale;
}

}  // namespace heartservo::tracking
