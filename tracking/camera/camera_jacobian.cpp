#include "tracking/camera/camera_jacobian.hpp"

namespace heartservo::tracking {

CameraParameters parameters_of(const Camera& c) {
  return (CameraParameters() << c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.k3, c.k4).finished();
}

Camera with_parameters(const Camera& camera, const CameraParameters& p) {
  Camera c = camera;
  c.fx = p[0];
  c.fy = p[1];
  c.cx = p[2];
  c.cy = p[3];
  c.k1 = p[4];
  c.k2 = p[5];
  c.k3 = p[6];
  c.k4 = p[7];
  return c;
}

Eigen::Matrix<double, 2, 8> parameter_jacobian(const Camera& camera, const Eigen::Vector2d& normalised) {
  const double x = normalised.x(), y = normalised.y(), r2 = x * x + y * y;
  const Eigen::Vector2d d = camera.distort(normalised);
  const double fx = camera.fx, fy = camera.fy;
  Eigen::Matrix<double, 2, 8> J;
  J << d.x(), 0, 1, 0, fx * r2 * x, fx * r2 * r2 * x, fx * 2 * x * y, fx * (r2 + 2 * x * x),  //
      0, d.y(), 0, 1, fy * r2 * y, fy * r2 * r2 * y, fy * (r2 + 2 * y * y), fy * 2 * x * y;
  return J;
}

Eigen::Matrix<double, 2, 3> projection_jacobian(const Camera& camera, const Eigen::Vector3d& point) {
  const Eigen::Vector2d n(point.x() / point.z(), point.y() / point.z());
  Eigen::Matrix<double, 2, 3> J_normalise;  // d (x/z, y/z) / d point
  J_normalise << 1 / point.z(), 0, -n.x() / point.z(), 0, 1 / point.z(), -n.y() / point.z();
  return Eigen::Vector2d(camera.fx, camera.fy).asDiagonal() * camera.distort_jacobian(n) * J_normalise;
}

}  // namespace heartservo::tracking
