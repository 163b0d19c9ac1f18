#pragma once
// One pixel of the landmark: what grey level a pose and a light predict, and how it changes with them.
//
//   I(u) = L(x, y) T(x, y) + c D(x, y) + b,     L = l0 + l1 x + l2 y + l3 x^2 + l4 x y + l5 y^2
//
// (x, y): where the pixel's ray meets the plate; T, D: the template and its softening (landmark_template.hpp); L: light
// that varies slowly over the plate; c: light times how much more the picture is blurred than the template; b: bias.
#include <Eigen/Geometry>
#include <array>

#include "tracking/landmark/landmark_template.hpp"

namespace heartservo::tracking {

inline constexpr int kLightParameters = 8;
inline constexpr int kDenseParameters = 6 + kLightParameters;
using DenseRow = Eigen::Matrix<double, kDenseParameters, 1>;

/// l0 ... l5, c, b.
using DenseLight = Eigen::Matrix<double, kLightParameters, 1>;

/// A plate at T_camera_target, prepared for many rays.
struct PlateView {
  Eigen::Vector3d right, down, normal, centre;
  double half_side_m;

  PlateView(const Eigen::Isometry3d& T_camera_target, double side_m)
      : right(T_camera_target.linear().col(0)),
        down(T_camera_target.linear().col(1)),
        normal(T_camera_target.linear().col(2)),
        centre(T_camera_target.translation()),
        half_side_m(0.5 * side_m) {}

  /// Where the ray (undistorted normalised point, 1) meets the plate's plane, from the plate's centre, m, camera frame.
  Eigen::Vector3d arm(const Eigen::Vector3d& ray) const {
    return normal.dot(centre) / normal.dot(ray) * ray - centre;
  }
};

/// Predicted grey level at a ray; `row`: its derivatives by the twist (v in m, w in rad; moved() in reprojection.hpp) and
/// by the light. False where the template does not reach.
inline bool predict_grey(const LandmarkTemplate& plate, const PlateView& view, const DenseLight& light,
                         const Eigen::Vector3d& ray, double& grey, DenseRow& row) {
  const Eigen::Vector3d arm = view.arm(ray);
  const double x = view.right.dot(arm) / view.half_side_m, y = view.down.dot(arm) / view.half_side_m;
  if (!plate.covers(x, y)) return false;
  PlateGrey T, D;
  plate.sample(x, y, T, D);
  const double L = light(0) + light(1) * x + light(2) * y + light(3) * x * x + light(4) * x * y + light(5) * y * y;
  const double L_x = light(1) + 2 * light(3) * x + light(4) * y, L_y = light(2) + light(4) * x + 2 * light(5) * y;
  grey = L * T.value + light(6) * D.value + light(7);
  const double I_x = L * T.dx + L_x * T.value + light(6) * D.dx, I_y = L * T.dy + L_y * T.value + light(6) * D.dy;
  // The plate's point on the ray moves by V = v + w x arm; the ray meets the plate again along the plate:
  // dx = right . (ray (normal . V) / (normal . ray) - V) / half side.
  const double slant = 1 / view.normal.dot(ray);
  const Eigen::Vector3d g_x = (view.right.dot(ray) * slant) * view.normal - view.right;
  const Eigen::Vector3d g_y = (view.down.dot(ray) * slant) * view.normal - view.down;
  const Eigen::Vector3d g = (I_x * g_x + I_y * g_y) / view.half_side_m;
  const Eigen::Vector3d turn = arm.cross(g);  // g . (w x arm) = w . (arm x g)
  row << g, turn, T.value, x * T.value, y * T.value, x * x * T.value, x * y * T.value, y * y * T.value, D.value, 1;
  return true;
}

}  // namespace heartservo::tracking
