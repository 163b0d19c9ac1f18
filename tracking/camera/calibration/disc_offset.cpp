#include "tracking/camera/calibration/disc_offset.hpp"

#include <Eigen/LU>
#include <cmath>

#include "tracking/camera/camera_jacobian.hpp"

namespace heartservo::tracking {

// The integral of the pixel over the picture's area, by Gauss's two points in r^2 and eight directions on the disc,
// each weighted by how much the camera enlarges there.
Eigen::Vector2d disc_offset(const Camera& camera, const Eigen::Isometry3d& T_camera_board,
                            const Eigen::Vector3d& centre, double diameter_m) {
  constexpr int DIRECTIONS = 8;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double area = 0;
  for (const double share : {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)})
    for (int k = 0; k < DIRECTIONS; ++k) {
      const double angle = 2 * M_PI * (k + share) / DIRECTIONS, radius = 0.5 * diameter_m * std::sqrt(share);
      const Eigen::Vector3d point =
          T_camera_board * (centre + radius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0));
      const Eigen::Matrix2d J = projection_jacobian(camera, point) * T_camera_board.linear().leftCols<2>();
      const double weight = std::abs(J.determinant());
      sum += weight * camera.project(point);
      area += weight;
    }
  return sum / area - camera.project(T_camera_board * centre);
}

}  // namespace heartservo::tracking
