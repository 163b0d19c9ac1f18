#include "tracking/landmark/visp_pose.hpp"

#include <visp3/core/vpException.h>
#include <visp3/core/vpPoint.h>
#include <visp3/vision/vpPose.h>

#include <cmath>
#include <limits>

#include "tracking/landmark/square_pose.hpp"

namespace heartservo::tracking {

namespace {

constexpr double MM = 1e3;  // vpPose::LAGRANGE is 11 degrees off for a 5 mm square given in metres, and right in mm

Eigen::Isometry3d from_visp(const vpHomogeneousMatrix& cMo) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) T.linear()(row, col) = cMo[row][col];
    T.translation()(row) = cMo[row][3] / MM;
  }
  return T;
}

}  // namespace

std::optional<Eigen::Isometry3d> visp_square_pose(const std::array<Eigen::Vector2d, 4>& normalised_corners,
                                                  double side_m) {
  std::optional<Eigen::Isometry3d> best;
  double best_residual = std::numeric_limits<double>::infinity();
  for (const auto method : {vpPose::DEMENTHON_VIRTUAL_VS, vpPose::LAGRANGE_VIRTUAL_VS}) {
    try {
      vpPose pose;
      for (int i = 0; i < 4; ++i) {
        const Eigen::Vector3d corner = MM * square_corner(i, side_m);
        vpPoint point(corner.x(), corner.y(), corner.z());
        point.set_x(normalised_corners[i].x());
        point.set_y(normalised_corners[i].y());
        pose.addPoint(point);
      }
      vpHomogeneousMatrix cMo;  // NOLINT(readability-identifier-naming): as ViSP writes it
      if (!pose.computePose(method, cMo)) continue;
      const double residual = pose.computeResidual(cMo);
      const Eigen::Isometry3d T = from_visp(cMo);
      if (!T.matrix().allFinite() || !(T.translation().z() > 0) || !(residual < best_residual)) continue;
      best = T;
      best_residual = residual;
    } catch (const vpException&) {  // a start that does not exist for these corners; the other may
    }
  }
  return best;
}

}  // namespace heartservo::tracking
