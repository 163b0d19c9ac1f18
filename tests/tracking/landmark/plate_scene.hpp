#pragma once
// Pictures of a painted plate, made by the dense pose's own model: for what must hold exactly. What must hold against
// another renderer is in tests/sim.
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "tests/tracking/landmark/square_scene.hpp"
#include "tracking/landmark/dense_equations.hpp"

namespace heartservo::test {

inline constexpr double kFrameGrey = 30;

/// Waves of several lengths and directions within a dark frame.
inline cv::Mat wavy_plate(int size = 300) {
  cv::Mat plate(size, size, CV_8UC1);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const double x = 2 * (i + 0.5) / size - 1, y = 2 * (j + 0.5) / size - 1;
      const double grey = 110 + 45 * std::sin(9 * x + 4 * y + 0.3) + 35 * std::sin(13 * y - 5 * x * x + 1) +
                          20 * std::cos(23 * x - 17 * y);
      plate.at<std::uint8_t>(j, i) = cv::saturate_cast<std::uint8_t>(std::max(std::abs(x), std::abs(y)) > 0.8 ? kFrameGrey : grey);
    }
  return plate;
}

/// Half a pixel of blur at 55 mm before the paper's camera, in half sides of the plate.
inline constexpr double kPlateBlur = 0.0185;

inline tracking::DenseLight some_light() {
  tracking::DenseLight light;
  light << 0.9, 0.05, -0.04, -0.01, 0.01, 0.0, 0.0, 6;
  return light;
}

/// CV_8UC1; tissue of one grey level around the plate; Gaussian noise on and near it.
inline cv::Mat plate_picture(std::mt19937_64& random, const tracking::Camera& camera,
                             const tracking::LandmarkTemplate& plate, const Eigen::Isometry3d& T,
                             const tracking::DenseLight& light, double sigma_grey) {
  const tracking::Quad corners = tracking::project_square(camera, T, SIDE);
  Eigen::Vector2d low = corners[0], high = low;
  for (const auto& corner : corners) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
  const tracking::PlateView view(T, SIDE);
  cv::Mat grey(camera.height, camera.width, CV_8UC1, cv::Scalar(90));
  tracking::DenseRow row;
  for (int v = std::max(0, int(low.y()) - 6); v < std::min(grey.rows, int(high.y()) + 6); ++v)
    for (int u = std::max(0, int(low.x()) - 6); u < std::min(grey.cols, int(high.x()) + 6); ++u) {
      const Eigen::Vector3d ray = camera.normalise({u, v}).homogeneous(), arm = view.arm(ray) / view.half_side_m;
      double g = 90;
      if (!tracking::predict_grey(plate, view, light, ray, g, row)) {
        const double x = view.right.dot(arm), y = view.down.dot(arm);
        // the dark frame goes on to the outline, where the template has no say
        if (std::max(std::abs(x), std::abs(y)) < 1) g = kFrameGrey * (light(0) + light(1) * x + light(2) * y) + light(7);
      }
      grey.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(g + normal(random, sigma_grey));
    }
  return grey;
}

}  // namespace heartservo::test
