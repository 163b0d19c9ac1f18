#pragma once
// A smooth picture known in closed form at every real point, for tests of interpolation, gradients and alignment.
#include <Eigen/Core>
#include <cmath>
#include <opencv2/core.hpp>

namespace heartservo::test {

/// Grey level 0..255 at (u, v) px: a sum of sinusoids of wavelengths 17 to 60 px.
inline double analytic_grey(double u, double v) {
  return 128 + 34 * std::sin(0.21 * u + 0.08 * v) + 30 * std::sin(0.11 * v - 0.05 * u + 1) +
         22 * std::cos(0.17 * u - 0.23 * v) + 20 * std::sin(0.37 * v + 0.04 * u + 2);
}

/// The picture I(u, v) = analytic_grey(H^-1 (u, v)): the analytic picture moved by H, plus gain and bias.
inline cv::Mat analytic_image(int width, int height, const Eigen::Matrix3d& H = Eigen::Matrix3d::Identity(),
                              double gain = 1, double bias = 0) {
  cv::Mat image(height, width, CV_8UC1);
  const Eigen::Matrix3d H_inverse = H.inverse();
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const Eigen::Vector3d p = H_inverse * Eigen::Vector3d(u, v, 1);
      image.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(gain * analytic_grey(p.x() / p.z(), p.y() / p.z()) + bias);
    }
  return image;
}

}  // namespace heartservo::test
