#include "tracking/camera/wide_camera.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace heartservo::tracking {

namespace {

Eigen::Vector2d distort(const WideCamera& wide, const Eigen::Vector2d& x) {
  const double r2 = x.squaredNorm();
  return wide.camera.distort(x) + wide.k5 * r2 * r2 * r2 * x;
}

Eigen::Matrix2d distort_jacobian(const WideCamera& wide, const Eigen::Vector2d& x) {
  const double r2 = x.squaredNorm();
  return wide.camera.distort_jacobian(x) +
         wide.k5 * r2 * r2 * (r2 * Eigen::Matrix2d::Identity() + 6 * x * x.transpose());
}

// True when the radial part grows all the way from the axis out to r (camera.cpp, before_the_fold).
bool before_the_fold(const WideCamera& wide, double r2) {
  constexpr int STEPS = 32;
  const Camera& c = wide.camera;
  for (int i = 1; i <= STEPS; ++i) {
    const double s = r2 * i / STEPS;
    if (!(1 + s * (3 * c.k1 + s * (5 * c.k2 + s * 7 * wide.k5)) > 0)) return false;
  }
  return true;
}

// Newton's method from the distorted point, with halved steps where they do not help.
Eigen::Vector2d undistort(const WideCamera& wide, const Eigen::Vector2d& distorted) {
  const Eigen::Vector2d nothing = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  if (!distorted.allFinite()) return nothing;
  Eigen::Vector2d x = distorted;
  while (!before_the_fold(wide, x.squaredNorm())) x *= 0.5;
  Eigen::Vector2d error = distorted - distort(wide, x);
  for (int iteration = 0; iteration < 100; ++iteration) {
    const Eigen::Matrix2d J = distort_jacobian(wide, x);
    if (!(J.determinant() > 0)) return nothing;
    Eigen::Vector2d step = J.inverse() * error;
    const bool tiny = step.squaredNorm() < 1e-26 * (1 + x.squaredNorm());
    if (tiny) return before_the_fold(wide, x.squaredNorm()) ? x : nothing;
    for (int halving = 0; halving < 30; ++halving, step *= 0.5)
      if ((distorted - distort(wide, x + step)).squaredNorm() < error.squaredNorm()) break;
    x += step;
    error = distorted - distort(wide, x);
  }
  return nothing;
}

}  // namespace

Eigen::Vector2d WideCamera::to_pixel(const Eigen::Vector2d& normalised) const {
  const Eigen::Vector2d d = distort(*this, normalised);
  return camera.to_pixel(d) + Eigen::Vector2d(skew * d.y(), 0);
}

Eigen::Vector2d WideCamera::normalise(const Eigen::Vector2d& pixel) const {
  const double yd = (pixel.y() - camera.cy) / camera.fy;
  const Eigen::Vector2d d((pixel.x() - camera.cx - skew * yd) / camera.fx, yd);
  return k5 == 0 ? camera.undistort(d) : undistort(*this, d);
}

std::vector<std::string> WideCamera::validate() const {
  if (is_paper_model()) return camera.validate();
  Camera bare = camera;
  bare.k1 = bare.k2 = bare.k3 = bare.k4 = 0;  // the distortion is checked below, all its terms together
  auto problems = bare.validate();
  for (const auto& [name, value] : {std::pair{"k1", camera.k1},
                                    {"k2", camera.k2},
                                    {"k3", camera.k3},
                                    {"k4", camera.k4},
                                    {"k5", k5},
                                    {"skew", skew}})
    if (!std::isfinite(value)) problems.push_back(fmt::format("{} is {}, must be a finite number", name, value));
  if (!problems.empty()) return problems;
  for (const auto& pixel : picture_grid(camera.width, camera.height))
    if (!normalise(pixel).allFinite()) {
      problems.push_back(fmt::format("the distortion cannot be inverted at pixel ({}, {})", pixel.x(), pixel.y()));
      break;
    }
  return problems;
}

std::vector<Eigen::Vector2d> picture_grid(int width, int height, int steps) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(static_cast<std::size_t>((steps + 1) * (steps + 1)));
  for (int j = 0; j <= steps; ++j)
    for (int i = 0; i <= steps; ++i)
      points.emplace_back(-0.5 + i * double(width) / steps, -0.5 + j * double(height) / steps);
  return points;
}

}  // namespace heartservo::tracking
