#pragma once
// Squares of the paper's size at known poses before the paper's camera.
#include <array>
#include <random>

#include "tests/support/random.hpp"
#include "tracking/landmark/reprojection.hpp"

namespace heartservo::test {

inline constexpr double SIDE = 0.005;  // m

/// A square at depth z (m), up to 8 mm beside the optical axis, turned at random about its normal and tilted by `tilt`
/// (rad) from the line of sight through its centre, to a random side.
inline Eigen::Isometry3d tilted_pose(std::mt19937_64& random, double tilt, double z) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(uniform(random, -0.008, 0.008), uniform(random, -0.008, 0.008), z);
  const double side = uniform(random, 0, 2 * M_PI);
  const Eigen::Quaterniond facing =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), T.translation().normalized());
  T.linear() = (facing * Eigen::AngleAxisd(tilt, Eigen::Vector3d(std::cos(side), std::sin(side), 0)) *
                Eigen::AngleAxisd(uniform(random, -0.7, 0.7), Eigen::Vector3d::UnitZ()))
                   .toRotationMatrix();
  return T;
}

inline tracking::Quad with_noise(std::mt19937_64& random, tracking::Quad corners, double sigma_px) {
  for (auto& corner : corners) corner += Eigen::Vector2d(normal(random, sigma_px), normal(random, sigma_px));
  return corners;
}

inline std::array<Eigen::Vector2d, 4> normalised_corners(const tracking::Camera& camera,
                                                         const tracking::Quad& corners) {
  std::array<Eigen::Vector2d, 4> result;
  for (int i = 0; i < 4; ++i) result[i] = camera.normalise(corners[i]);
  return result;
}

}  // namespace heartservo::test
