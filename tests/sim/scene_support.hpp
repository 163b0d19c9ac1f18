#pragma once
// The paper's camera, and pictures of Gaussian dots whose centres can be measured to a hundredth of a pixel.
#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "sim/endoscope/tissue_texture.hpp"
#include "tracking/camera/camera.hpp"

namespace heartservo::test {

/// Table 2.
inline tracking::Camera paper_camera() {
  tracking::Camera camera;
  camera.width = camera.height = 512;
  camera.fx = 593.6, camera.fy = 594.5, camera.cx = 279.6, camera.cy = 223.7;
  camera.k1 = -0.241, camera.k2 = 0.207, camera.k3 = 0.005, camera.k4 = 0.008;
  return camera;
}

inline constexpr double kDotBackground = 30;
inline constexpr double kDotSigma_m = 0.16e-3;

/// 2048^2 texels on 80 mm with a bright dot, 1.7 px wide, at each (a, b).
inline std::shared_ptr<const sim::TissueTexture> dot_texture(const std::vector<Eigen::Vector2d>& dots) {
  constexpr int n = 2048;
  const double density = n / 0.08, sigma = kDotSigma_m * density;
  cv::Mat grey(n, n, CV_32FC1, cv::Scalar(kDotBackground));
  for (const auto& dot : dots) {
    const double x = dot.x() * density + (n - 1) / 2.0, y = dot.y() * density + (n - 1) / 2.0;
    const int reach = static_cast<int>(5 * sigma) + 1, ci = static_cast<int>(x), cj = static_cast<int>(y);
    for (int j = cj - reach; j <= cj + reach; ++j)
      for (int i = ci - reach; i <= ci + reach; ++i)
        if (i >= 0 && j >= 0 && i < n && j < n)
          grey.at<float>(j, i) +=
              static_cast<float>(210 * std::exp(-((i - x) * (i - x) + (j - y) * (j - y)) / (2 * sigma * sigma)));
  }
  return std::make_shared<const sim::TissueTexture>(sim::TissueTexture::from_planes(grey, density));
}

/// Centre of the dot near `guess` (px): centroid of `above_background(u, v)` under a Gaussian window that follows it.
template <class Grey>
Eigen::Vector2d dot_centre(const Grey& above_background, Eigen::Vector2d guess) {
  constexpr double kWindow_px = 1.6;
  for (int step = 0; step < 60; ++step) {
    Eigen::Vector2d sum(0, 0);
    double total = 0;
    const int u0 = static_cast<int>(guess.x()) - 6, v0 = static_cast<int>(guess.y()) - 6;
    for (int v = v0; v < v0 + 14; ++v)
      for (int u = u0; u < u0 + 14; ++u) {
        const double du = u - guess.x(), dv = v - guess.y();
        const double weight = above_background(u, v) * std::exp(-(du * du + dv * dv) / (2 * kWindow_px * kWindow_px));
        sum += weight * Eigen::Vector2d(du, dv), total += weight;
      }
    // The window shows about half of a displacement; a longer step makes up for it.
    const Eigen::Vector2d move = 1.5 * sum / total;
    guess += move;
    if (move.norm() < 1e-5) break;
  }
  return guess;
}

inline Eigen::Vector2d dot_centre(const cv::Mat& grey, const Eigen::Vector2d& guess) {
  return dot_centre([&](int u, int v) { return grey.at<std::uint8_t>(v, u) - kDotBackground; }, guess);
}

inline bool inside(const tracking::Camera& camera, const Eigen::Vector2d& pixel, double margin) {
  return pixel.x() > margin && pixel.y() > margin && pixel.x() < camera.width - 1 - margin &&
         pixel.y() < camera.height - 1 - margin;
}

}  // namespace heartservo::test
