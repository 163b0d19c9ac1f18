#include "tracking/frames/v4l2/round_picture.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "tracking/settings/errors.hpp"

namespace heartservo::tracking::v4l2 {

namespace {

constexpr int MOST_BLACK = 24;            // grey level that black still has (16 in limited range, and noise)
constexpr double LEAST_RADIUS = 0.2;      // of the shorter side
constexpr double MOST_OFF_CIRCLE = 0.02;  // of the radius: RMS distance of the outline from the circle

struct Circle {
  cv::Point2d centre;
  double radius = 0, rms = 0;
};

// Least squares on x^2 + y^2 + a x + b y + c = 0.
Circle fitted(const std::vector<cv::Point2d>& points) {
  cv::Mat A(static_cast<int>(points.size()), 3, CV_64F), b(static_cast<int>(points.size()), 1, CV_64F), x;
  for (int i = 0; i < A.rows; ++i) {
    const auto& p = points[static_cast<std::size_t>(i)];
    A.at<double>(i, 0) = p.x, A.at<double>(i, 1) = p.y, A.at<double>(i, 2) = 1;
    b.at<double>(i) = -(p.x * p.x + p.y * p.y);
  }
  cv::solve(A, b, x, cv::DECOMP_SVD);
  Circle circle;
  circle.centre = {-0.5 * x.at<double>(0), -0.5 * x.at<double>(1)};
  circle.radius = std::sqrt(std::max(0.0, circle.centre.dot(circle.centre) - x.at<double>(2)));
  for (const auto& p : points) circle.rms += std::pow(cv::norm(p - circle.centre) - circle.radius, 2);
  circle.rms = std::sqrt(circle.rms / static_cast<double>(points.size()));
  return circle;
}

}  // namespace

std::optional<cv::Rect> round_picture(const cv::Mat& grey) {
  cv::Mat bright;
  cv::medianBlur(grey, bright, 5);
  cv::threshold(bright, bright, MOST_BLACK, 255, cv::THRESH_BINARY);
  // the first and last bright pixel of every line lie on the disc's outline, whatever is dark inside it
  std::vector<cv::Point2d> outline;
  for (int row = 0; row < bright.rows; ++row) {
    const std::uint8_t* line = bright.ptr(row);
    int left = 0, right = bright.cols - 1;
    while (left < bright.cols && !line[left]) ++left;
    while (right > left && !line[right]) --right;
    if (right - left < bright.cols / 20) continue;
    if (left > 0) outline.emplace_back(left - 0.5, row);
    if (right < bright.cols - 1) outline.emplace_back(right + 0.5, row);
  }
  if (outline.size() < static_cast<std::size_t>(bright.rows) / 2) return std::nullopt;
  const Circle circle = fitted(outline);
  if (circle.radius < LEAST_RADIUS * std::min(grey.rows, grey.cols) || circle.rms > MOST_OFF_CIRCLE * circle.radius)
    return std::nullopt;
  const auto even = [](double v, int limit) {
    return std::clamp(2 * static_cast<int>(std::lround(v / 2)), 0, limit & ~1);
  };
  const int left = even(circle.centre.x - circle.radius, grey.cols),
            top = even(circle.centre.y - circle.radius, grey.rows);
  const int right = even(circle.centre.x + circle.radius + 1, grey.cols),
            bottom = even(circle.centre.y + circle.radius + 1, grey.rows);
  if (right - left < 32 || bottom - top < 32) return std::nullopt;
  return cv::Rect(left, top, right - left, bottom - top);
}

cv::Rect crop_of(const std::string& crop, const cv::Mat& grey, const std::string& device) {
  if (crop.empty()) return {};
  if (crop == "round") {
    const auto found = round_picture(grey);
    if (!found)
      throw DeviceError(device +
                        ": crop=round: the first picture shows no bright disc on black; hold the endoscope into "
                        "the light, or give crop=X:Y:WIDTH:HEIGHT");
    return *found;
  }
  cv::Rect rect;
  std::sscanf(crop.c_str(), "%d:%d:%d:%d", &rect.x, &rect.y, &rect.width, &rect.height);
  if ((rect & cv::Rect({0, 0}, grey.size())) != rect || rect.area() == 0)
    throw DeviceError(
        fmt::format("{}: crop={} is not inside the picture of {} x {} px", device, crop, grey.cols, grey.rows));
  return rect;
}

}  // namespace heartservo::tracking::v4l2
