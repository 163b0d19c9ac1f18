#include "tracking/camera/calibration/circle_centres.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace heartservo::tracking {

namespace {

constexpr int SMALLEST_AREA = 12;  // px^2

// Of a filled ellipse, area = pi/4 times its two diameters; 4 sqrt(eigenvalue of the second moments) is a diameter.
bool is_round(const cv::Moments& m) {
  if (m.m00 < SMALLEST_AREA) return false;
  const double a = m.mu20 / m.m00, b = m.mu11 / m.m00, c = m.mu02 / m.m00;
  const double middle = (a + c) / 2, half = std::sqrt((a - c) * (a - c) / 4 + b * b);
  const double large = middle + half, small = middle - half;
  if (!(small > 0) || large > 16 * small) return false;  // seen at up to 75 degrees
  const double area = 4 * M_PI * std::sqrt(large * small);
  return std::abs(m.m00 / area - 1) < 0.15;
}

void add_spots(const cv::Mat& binary, std::vector<cv::Point2f>& spots) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(binary, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  for (const auto& contour : contours) {
    const cv::Moments m = cv::moments(contour);
    if (!is_round(m)) continue;
    const cv::Point2f centre(static_cast<float>(m.m10 / m.m00), static_cast<float>(m.m01 / m.m00));
    const bool known = std::any_of(spots.begin(), spots.end(),
                                   [&](const cv::Point2f& s) { return cv::norm(s - centre) < 0.5 * std::sqrt(m.m00); });
    if (!known) spots.push_back(centre);
  }
}

}  // namespace

std::vector<cv::Point2f> dark_spots(const cv::Mat& grey) {
  std::vector<cv::Point2f> spots;
  cv::Mat smooth, binary;
  cv::GaussianBlur(grey, smooth, {3, 3}, 0);
  // The window of the local threshold must be larger than a circle, whose size is not known.
  for (const int divisor : {6, 12, 24, 48}) {
    const int window = std::max(7, std::min(grey.cols, grey.rows) / divisor) | 1;
    cv::adaptiveThreshold(smooth, binary, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV, window, 5);
    cv::rectangle(binary, {0, 0, binary.cols, binary.rows}, cv::Scalar(0));  // cut circles have another centre
    add_spots(binary, spots);
  }
  return spots;
}

bool measure_disc(const cv::Mat& grey, const Eigen::Vector2d& near, double pitch_px, DiscMeasurement& disc) {
  const int reach = static_cast<int>(std::floor(0.5 * pitch_px));
  const int u0 = static_cast<int>(std::lround(near.x())), v0 = static_cast<int>(std::lround(near.y()));
  if (reach < 3 || u0 - reach < 0 || v0 - reach < 0 || u0 + reach >= grey.cols || v0 + reach >= grey.rows) return false;
  const auto value = [&](int u, int v) { return double(grey.at<std::uint8_t>(v0 + v, u0 + u)); };

  // Twice: the lighter half of the window is paper at first; then what is near the plane through it.
  std::vector<double> sorted;
  for (int v = -reach; v <= reach; ++v)
    for (int u = -reach; u <= reach; ++u) sorted.push_back(value(u, v));
  const auto rank = [&](double share) {
    const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), at, sorted.end());
    return *at;
  };
  const double dark = rank(0.05), light = rank(0.9);
  if (light - dark < 15) return false;
  Eigen::Vector3d plane(0.5 * (light + dark), 0, 0);
  double margin = 0;
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (int v = -reach; v <= reach; ++v)
      for (int u = -reach; u <= reach; ++u) {
        const Eigen::Vector3d x(1, u, v);
        if (value(u, v) < plane.dot(x) - margin) continue;
        A += x * x.transpose();
        b += value(u, v) * x;
      }
    plane = A.ldlt().solve(b);
    margin = 0.15 * (light - dark);
  }
  if (!plane.allFinite()) return false;

  double sum = 0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  const double depth = 1 - dark / std::max(1.0, plane.x());
  for (int v = -reach; v <= reach; ++v)
    for (int u = -reach; u <= reach; ++u) {
      const double paper = plane.dot(Eigen::Vector3d(1, u, v));
      const double darkness = (1 - value(u, v) / std::max(1.0, paper)) / depth;
      if (darkness < 0.1) continue;  // the paper's own grain
      sum += darkness;
      moment += darkness * Eigen::Vector2d(u, v);
    }
  if (!(sum > SMALLEST_AREA / 2.0)) return false;
  disc.centre = Eigen::Vector2d(u0, v0) + moment / sum;
  disc.area_px2 = sum;
  return (disc.centre - near).norm() < 0.25 * pitch_px;
}

}  // namespace heartservo::tracking
