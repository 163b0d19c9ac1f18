#pragma once
// The noise floor of a planar tracker: the mean corner error that no unbiased estimate of a homography can go below on
// one pair of pictures (Cramer-Rao), both with white noise of sigma grey levels. The bound is the covariance
// 2 sigma^2 (sum J^T J)^-1 of the eight parameters, carried to the corners; sigma includes rounding, 1/12 grey^2.
#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <opencv2/core/mat.hpp>

#include "tracking/planar/quad.hpp"

namespace heartservo::test {

/// px. `grey`: CV_8UC1, best without noise; `region`: axis-parallel.
inline double corner_error_floor(const cv::Mat& grey, const tracking::Quad& region, double sigma_grey) {
  using Jacobian = Eigen::Matrix<double, 2, 8>;
  const Eigen::Vector2d middle = tracking::centre(region), half = (region[2] - region[0]) / 2;
  const auto motion = [&](const Eigen::Vector2d& at) {  // d point / d parameters at the identity
    const double x = (at.x() - middle.x()) / half.x(), y = (at.y() - middle.y()) / half.y();
    Jacobian J;
    J << x, y, 1, 0, 0, 0, -x * x, -x * y, 0, 0, 0, x, y, 1, -x * y, -y * y;
    return J;
  };
  Eigen::Matrix<double, 8, 8> information = Eigen::Matrix<double, 8, 8>::Zero();
  for (int v = static_cast<int>(region[0].y()); v < static_cast<int>(region[2].y()); ++v)
    for (int u = static_cast<int>(region[0].x()); u < static_cast<int>(region[2].x()); ++u) {
      if (grey.at<std::uint8_t>(v, u) > 250) continue;
      const Eigen::RowVector2d g(0.5 * (grey.at<std::uint8_t>(v, u + 1) - grey.at<std::uint8_t>(v, u - 1)),
                                 0.5 * (grey.at<std::uint8_t>(v + 1, u) - grey.at<std::uint8_t>(v - 1, u)));
      const Eigen::Matrix<double, 1, 8> J = g * motion({u, v});
      information += J.transpose() * J;
    }
  const double variance = 2 * (sigma_grey * sigma_grey + 1.0 / 12);
  const Eigen::Matrix<double, 8, 8> covariance = variance * information.inverse();
  double sum = 0;
  for (const auto& corner : region) {
    const Jacobian J = motion(corner);
    sum += std::sqrt(M_PI / 4 * (J * covariance * J.transpose()).trace()) / 4;  // mean length of a round Gaussian
  }
  return sum;
}

}  // namespace heartservo::test
