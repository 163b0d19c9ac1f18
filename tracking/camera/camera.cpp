#include "tracking/camera/camera.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace heartservo::tracking {

namespace {

// True when the radial part r (1 + k1 r^2 + k2 r^4) grows all the way from the axis out to r: what lies behind its
// first turning point is a folded-over mirror image that no lens shows, however well the polynomial can be solved
// there.
bool before_the_fold(const Camera& camera, double r2) {
  const auto slope = [&](double s) { return 1 + 3 * camera.k1 * s + 5 * camera.k2 * s * s; };
  if (!(slope(r2) > 0)) return false;
  const double vertex = camera.k2 != 0 ? -3 * camera.k1 / (10 * camera.k2) : 0;
  return !(vertex > 0 && vertex < r2) || slope(vertex) > 0;
}

void check_numbers(const Camera& camera, std::vector<std::string>& problems) {
  if (camera.width <= 0) problems.push_back(fmt::format("width is {} px, must be positive", camera.width));
  if (camera.height <= 0) problems.push_back(fmt::format("height is {} px, must be positive", camera.height));
  const std::pair<const char*, double> numbers[] = {
      {"fx", camera.fx}, {"fy", camera.fy}, {"cx", camera.cx}, {"cy", camera.cy},
      {"k1", camera.k1}, {"k2", camera.k2}, {"k3", camera.k3}, {"k4", camera.k4},
  };
  for (const auto& [name, value] : numbers)
    if (!std::isfinite(value)) problems.push_back(fmt::format("{} is {}, must be a finite number", name, value));
  if (camera.fx <= 0) problems.push_back(fmt::format("fx is {} px, must be positive", camera.fx));
  if (camera.fy <= 0) problems.push_back(fmt::format("fy is {} px, must be positive", camera.fy));
}

// Off-centre crops move the principal point out of the picture, but not by more than half the picture.
void check_principal_point(const Camera& camera, std::vector<std::string>& problems) {
  const auto check = [&](const char* name, double value, int size) {
    if (value < -0.5 * size || value > 1.5 * size)
      problems.push_back(
          fmt::format("{} is {} px, more than half a picture outside the picture of {} px", name, value, size));
  };
  check("cx", camera.cx, camera.width);
  check("cy", camera.cy, camera.height);
}

void check_distortion(const Camera& camera, std::vector<std::string>& problems) {
  constexpr int STEPS = 32;
  for (int j = 0; j <= STEPS; ++j)
    for (int i = 0; i <= STEPS; ++i) {
      const Eigen::Vector2d pixel(-0.5 + i * double(camera.width) / STEPS, -0.5 + j * double(camera.height) / STEPS);
      if (camera.normalise(pixel).allFinite()) continue;
      problems.push_back(fmt::format("distortion k1..k4 = {}, {}, {}, {} cannot be inverted at pixel ({}, {})",
                                     camera.k1, camera.k2, camera.k3, camera.k4, pixel.x(), pixel.y()));
      return;
    }
}

}  // namespace

Eigen::Vector2d Camera::distort(const Eigen::Vector2d& normalised) const {
  const double x = normalised.x(), y = normalised.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * k2);
  return {radial * x + 2 * k3 * x * y + k4 * (r2 + 2 * x * x), radial * y + k3 * (r2 + 2 * y * y) + 2 * k4 * x * y};
}

Eigen::Matrix2d Camera::distort_jacobian(const Eigen::Vector2d& normalised) const {
  const double x = normalised.x(), y = normalised.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * k2);
  const double slope = 2 * (k1 + 2 * k2 * r2);  // d radial / dx = slope x, d radial / dy = slope y
  const double mixed = slope * x * y + 2 * k3 * x + 2 * k4 * y;
  Eigen::Matrix2d J;
  J << radial + slope * x * x + 2 * k3 * y + 6 * k4 * x, mixed,  //
      mixed, radial + slope * y * y + 6 * k3 * y + 2 * k4 * x;
  return J;
}

Eigen::Vector2d Camera::undistort(const Eigen::Vector2d& distorted) const {
  if (!has_distortion()) return distorted;
  const Eigen::Vector2d nothing = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  if (!distorted.allFinite()) return nothing;

  // Start on the near side of the fold; from there Newton closes in on the nearer root.
  Eigen::Vector2d x = distorted;
  while (!before_the_fold(*this, x.squaredNorm())) x *= 0.5;

  Eigen::Vector2d error = distorted - distort(x);
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Eigen::Matrix2d J = distort_jacobian(x);
    if (!(J.determinant() > 0)) return nothing;
    const Eigen::Vector2d full_step = J.inverse() * error;
    if (full_step.squaredNorm() <= 1e-30 * (1 + x.squaredNorm())) return x;
    Eigen::Vector2d step = full_step;
    Eigen::Vector2d moved = x + step;
    // A step that crosses the fold or makes the error larger is halved; both happen only near the fold.
    for (int halving = 0; halving < 30 && (!before_the_fold(*this, moved.squaredNorm()) ||
                                           (distorted - distort(moved)).squaredNorm() > error.squaredNorm());
         ++halving) {
      step *= 0.5;
      moved = x + step;
    }
    const Eigen::Vector2d moved_error = distorted - distort(moved);
    if (!(moved_error.squaredNorm() < error.squaredNorm()))  // as good as the arithmetic gets, or stuck at the fold
      return full_step.squaredNorm() < 1e-26 * (1 + x.squaredNorm()) ? x : nothing;
    x = moved;
    error = moved_error;
  }
  return nothing;
}

std::vector<std::string> Camera::validate() const {
  std::vector<std::string> problems;
  check_numbers(*this, problems);
  if (!problems.empty()) return problems;  // what follows computes with these numbers
  check_principal_point(*this, problems);
  check_distortion(*this, problems);
  return problems;
}

Camera Camera::pinhole(int width, int height, double horizontal_field_of_view) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = width / (2 * std::tan(horizontal_field_of_view / 2));
  camera.cx = (width - 1) / 2.0;  // (0, 0) is the centre of the first pixel
  camera.cy = (height - 1) / 2.0;
  return camera;
}

}  // namespace heartservo::tracking
