#include "tracking/landmark/plate_learner.hpp"

#include <opencv2/imgproc.hpp>

#include "tracking/landmark/reprojection.hpp"

namespace heartservo::tracking {

namespace {

constexpr double kSoftening_px = 0.5;  // one step of blur, should a later picture be less sharp

/// Cubic convolution of the four by four pixels around p. Not by cv::remap: it rounds places to 1/32 px.
double interpolate(const cv::Mat& grey, const Eigen::Vector2d& p) {
  const int u = static_cast<int>(p.x()), v = static_cast<int>(p.y());
  const auto cubic = [](double a, double b, double c, double d, double f) {
    return b + 0.5 * f * (c - a + f * (2 * a - 5 * b + 4 * c - d + f * (3 * (b - c) + d - a)));
  };
  double rows[4];
  for (int j = 0; j < 4; ++j) {
    const std::uint8_t* g = grey.ptr<std::uint8_t>(v + j - 1) + u - 1;
    rows[j] = cubic(g[0], g[1], g[2], g[3], p.x() - u);
  }
  return cubic(rows[0], rows[1], rows[2], rows[3], p.y() - v);
}

}  // namespace

LandmarkTemplate PlateLearner::learn(const cv::Mat& grey, double side_m, const Eigen::Isometry3d& T_camera_target,
                                     const DenseLight& light) {
  constexpr int n = LandmarkTemplate::kSize;
  cv::Mat picture(n, n, CV_32FC1);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = (2 * i + 1.0) / n - 1, y = (2 * j + 1.0) / n - 1;
      const Eigen::Vector2d p = camera_.project(T_camera_target * Eigen::Vector3d(x * side_m / 2, y * side_m / 2, 0));
      if (!(p.x() >= 1 && p.y() >= 1 && p.x() < grey.cols - 2 && p.y() < grey.rows - 2)) return {};
      const double gain =
          light(0) + light(1) * x + light(2) * y + light(3) * x * x + light(4) * x * y + light(5) * y * y;
      picture.at<float>(j, i) = static_cast<float>((interpolate(grey, p) - light(7)) / gain);
    }
  ++count_;
  if (mean_.empty())
    mean_ = picture;
  else
    mean_ += (picture - mean_) / count_;
  const double side_px = std::sqrt(area(project_square(camera_, T_camera_target, side_m)));
  return LandmarkTemplate(mean_, 2 * kSoftening_px / side_px, true);
}

}  // namespace heartservo::tracking
