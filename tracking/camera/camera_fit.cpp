#include "tracking/camera/camera_fit.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "tracking/camera/camera_jacobian.hpp"

namespace heartservo::tracking {

namespace {

constexpr int TERMS = 10;  // the eight of camera_jacobian.hpp, k5, skew
using Vector = Eigen::Matrix<double, TERMS, 1>;
using Matrix = Eigen::Matrix<double, TERMS, TERMS>;

// Rays through the picture as `from` sees it, and where it sees them.
struct Rays {
  std::vector<Eigen::Vector2d> normalised, pixels;
};

Rays rays_of(const WideCamera& from) {
  Rays rays;
  rays.pixels = picture_grid(from.camera.width, from.camera.height);
  for (const auto& pixel : rays.pixels) rays.normalised.push_back(from.normalise(pixel));
  return rays;
}

Eigen::Matrix<double, 2, TERMS> jacobian(const WideCamera& wide, const Eigen::Vector2d& n) {
  const double r2 = n.squaredNorm(), r6 = r2 * r2 * r2;
  const double yd = wide.camera.distort(n).y() + wide.k5 * r6 * n.y();
  Eigen::Matrix<double, 2, TERMS> J;
  J.leftCols<8>() = parameter_jacobian(wide.camera, n);
  J.col(8) << wide.camera.fx * r6 * n.x(), wide.camera.fy * r6 * n.y();
  J.col(9) << yd, 0;
  // what k5 and skew add to the columns of the eight
  J(0, 0) += wide.k5 * r6 * n.x();
  J(1, 1) += wide.k5 * r6 * n.y();
  if (wide.skew != 0) {
    J.row(0).segment<4>(4) += wide.skew / wide.camera.fy * J.row(1).segment<4>(4);
    J(0, 8) += wide.skew * r6 * n.y();
  }
  return J;
}

double sum_of_squares(const WideCamera& wide, const Rays& rays) {
  double sum = 0;
  for (std::size_t i = 0; i < rays.pixels.size(); ++i)
    sum += (rays.pixels[i] - wide.to_pixel(rays.normalised[i])).squaredNorm();
  return sum;
}

WideCamera moved(const WideCamera& wide, const Vector& step) {
  return {with_parameters(wide.camera, parameters_of(wide.camera) + step.head<8>()), wide.k5 + step[8],
          wide.skew + step[9]};
}

// Levenberg-Marquardt over the free terms.
WideCamera refined(WideCamera wide, const Rays& rays, const Eigen::Array<bool, TERMS, 1>& is_free) {
  double cost = sum_of_squares(wide, rays), lambda = 1e-6;
  for (int iteration = 0; iteration < 100 && lambda < 1e6; ++iteration) {
    Matrix A = Matrix::Zero();
    Vector b = Vector::Zero();
    for (std::size_t i = 0; i < rays.pixels.size(); ++i) {
      auto J = jacobian(wide, rays.normalised[i]);
      for (int k = 0; k < TERMS; ++k)
        if (!is_free[k]) J.col(k).setZero();
      A += J.transpose() * J;
      b += J.transpose() * (rays.pixels[i] - wide.to_pixel(rays.normalised[i]));
    }
    A.diagonal() *= 1 + lambda;
    for (int k = 0; k < TERMS; ++k)
      if (!is_free[k]) A(k, k) = 1;
    const Vector scale = A.diagonal().cwiseSqrt().cwiseInverse();
    const Matrix scaled = scale.asDiagonal() * A * scale.asDiagonal();
    const Vector step = scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * b);
    const WideCamera next = moved(wide, step);
    const double next_cost = sum_of_squares(next, rays);
    if (!(next_cost < cost)) {
      lambda *= 10;
      continue;
    }
    const bool done = cost - next_cost < 1e-14 * cost;
    wide = next;
    cost = next_cost;
    lambda = std::max(lambda * 0.1, 1e-12);
    if (done) break;
  }
  return wide;
}

void add(PictureError& error, double squared_px2, const Eigen::Vector2d& pixel, double count) {
  error.rms_px = std::sqrt(error.rms_px * error.rms_px + squared_px2 / count);
  if (squared_px2 <= error.max_px * error.max_px) return;
  error.max_px = std::sqrt(squared_px2);
  error.worst_px = pixel;
}

}  // namespace

CameraFit fit_camera(const WideCamera& from, const CameraTerms& terms) {
  CameraFit fit;
  fit.camera = from;
  Eigen::Array<bool, TERMS, 1> is_free;
  is_free << true, true, true, true, true, terms.k2, terms.tangential, terms.tangential, terms.k5, terms.skew;
  Camera& camera = fit.camera.camera;
  double* const values[] = {&camera.k2, &camera.k3, &camera.k4, &fit.camera.k5, &fit.camera.skew};
  const char* const names[] = {"k2", "k3", "k4", "k5", "skew"};
  for (int k = 0; k < 5; ++k) {
    if (is_free[5 + k] || *values[k] == 0) continue;
    fit.lost.emplace_back(names[k]);
    *values[k] = 0;
  }
  if (fit.lost.empty()) return fit;
  const Rays rays = rays_of(from);
  fit.camera = refined(fit.camera, rays, is_free);
  const double count = static_cast<double>(rays.pixels.size());
  for (std::size_t i = 0; i < rays.pixels.size(); ++i)
    add(fit.error, (rays.pixels[i] - fit.camera.to_pixel(rays.normalised[i])).squaredNorm(), rays.pixels[i], count);
  return fit;
}

BackwardFit fit_backward(const Camera& camera, const WideCamera& from) {
  const Rays rays = rays_of(from);
  const Eigen::Array2d f(camera.fx, camera.fy);
  double numerator = 0, denominator = 0;
  for (std::size_t i = 0; i < rays.pixels.size(); ++i) {
    const Eigen::Vector2d d = camera.from_pixel(rays.pixels[i]);
    const Eigen::Array2d slope = f * (d.squaredNorm() * d).array();
    numerator += (slope * f * (rays.normalised[i] - d).array()).sum();
    denominator += slope.square().sum();
  }
  BackwardFit fit;
  fit.kdu = numerator / denominator;
  const double count = static_cast<double>(rays.pixels.size());
  for (std::size_t i = 0; i < rays.pixels.size(); ++i) {
    const Eigen::Vector2d d = camera.from_pixel(rays.pixels[i]);
    const Eigen::Array2d e = f * (rays.normalised[i] - (1 + fit.kdu * d.squaredNorm()) * d).array();
    add(fit.error, e.square().sum(), rays.pixels[i], count);
  }
  return fit;
}

}  // namespace heartservo::tracking
