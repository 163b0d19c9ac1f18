#pragma once
// A painted plane before a stereo endoscope, exactly as both cameras see it.
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>

#include "tests/support/random.hpp"
#include "tracking/camera/stereo_camera.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::test {

inline tracking::StereoCamera small_stereo() {
  tracking::StereoCamera stereo;
  tracking::Camera camera;
  camera.width = 200, camera.height = 160;
  camera.fx = 240, camera.fy = 242, camera.cx = 98, camera.cy = 82;
  camera.k1 = -0.1, camera.k2 = 0.03, camera.k3 = 0.002, camera.k4 = -0.001;
  stereo.left = stereo.right = camera;
  stereo.right.fx = 244, stereo.right.cx = 103;
  stereo.T_right_left.linear() = (Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitX()))
                                     .toRotationMatrix();
  stereo.T_right_left.translation() = Eigen::Vector3d(-0.005, 0.0002, -0.0003);
  return stereo;
}

using Paint = std::function<double(double, double)>;  // grey at (x, y), m

inline double tissue_paint(double x, double y) {
  const double u = 1e3 * x, v = 1e3 * y;
  return 120 + 35 * std::sin(2.1 * u + 0.7 * v) * std::cos(1.3 * v - 0.4 * u) + 25 * std::sin(3.3 * u - 2.2 * v + 1) +
         15 * std::cos(4.1 * v + 0.3 * u * v);
}

/// z = depth + slope . (x, y)
struct PaintedPlane {
  double depth_m = 0.05;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double depth_at(const Eigen::Vector2d& ray) const { return depth_m / (1 - slope.dot(ray)); }
};

/// The plane is in the left frame; `T_camera_left`: identity for the left camera.
inline cv::Mat see(const tracking::Camera& camera, const Eigen::Isometry3d& T_camera_left, const PaintedPlane& plane,
                   double noise, std::mt19937_64& random, const Paint& paint = tissue_paint) {
  cv::Mat picture(camera.height, camera.width, CV_8UC1);
  const Eigen::Isometry3d back = T_camera_left.inverse();
  const Eigen::Vector3d across(-plane.slope.x(), -plane.slope.y(), 1);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = back.linear() * camera.normalise(Eigen::Vector2d(u, v)).homogeneous();
      const Eigen::Vector3d o = back.translation();
      const Eigen::Vector3d p = o + (plane.depth_m - across.dot(o)) / across.dot(ray) * ray;
      picture.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(std::lround(paint(p.x(), p.y()) + (noise > 0 ? normal(random, noise) : 0)));
    }
  return picture;
}

}  // namespace heartservo::test
