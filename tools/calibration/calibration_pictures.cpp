#include "tools/calibration/calibration_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace heartservo::tools {

namespace {

using tracking::Corners;

const cv::Scalar WHITE(255, 255, 255), INK(60, 50, 40), LINE(220, 214, 206), EMPTY(205, 220, 248);
constexpr int SHIFT = 4;  // fixed point of OpenCV's drawing: 1/16 px

// Okabe and Ito's palette, as in report.css.
cv::Scalar colour(std::size_t i) {
  static const std::array<cv::Scalar, 7> colours{cv::Scalar(178, 114, 0), {0, 94, 213},  {115, 158, 0},
                                                 {167, 121, 204},         {0, 159, 230}, {233, 180, 86},
                                                 {107, 107, 107}};
  return colours[i % colours.size()];
}

cv::Point fixed(const Eigen::Vector2d& p) {
  return {static_cast<int>(std::lround(p.x() * (1 << SHIFT))), static_cast<int>(std::lround(p.y() * (1 << SHIFT)))};
}

void dot(cv::Mat& image, const Eigen::Vector2d& p, double radius, const cv::Scalar& c) {
  cv::circle(image, fixed(p), static_cast<int>(radius * (1 << SHIFT)), c, cv::FILLED, cv::LINE_AA, SHIFT);
}

void text(cv::Mat& image, const std::string& what, cv::Point at, double size = 0.5) {
  cv::putText(image, what, at, cv::FONT_HERSHEY_SIMPLEX, size, INK, 1, cv::LINE_AA);
}

// 1, 2 or 5 times a power of ten, at most `value`.
double round_down(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {5.0, 2.0})
    if (value >= step * power) return step * power;
  return power;
}

}  // namespace

cv::Mat draw_picture_coverage(const CalibrationRun& run, std::size_t side, double& enlarged) {
  const double scale = 960.0 / std::max(run.views.width, run.views.height);
  const auto place = [&](const Eigen::Vector2d& pixel) {
    return Eigen::Vector2d(scale * (pixel + Eigen::Vector2d(0.5, 0.5)));
  };
  const int width = static_cast<int>(scale * run.views.width), height = static_cast<int>(scale * run.views.height);
  cv::Mat image(height, width, CV_8UC3, WHITE);
  const auto& coverage = run.picture[side];
  for (int row = 0; row < coverage.rows; ++row)
    for (int column = 0; column < coverage.columns; ++column) {
      const cv::Point from(column * width / coverage.columns, row * height / coverage.rows);
      const cv::Point to((column + 1) * width / coverage.columns, (row + 1) * height / coverage.rows);
      if (coverage.at(column, row) == 0) cv::rectangle(image, from, to, EMPTY, cv::FILLED);
      cv::rectangle(image, from, to, LINE);
    }
  const auto& c = run.calibration;
  enlarged = round_down(std::max(1.0, 30 / (scale * std::max(1e-6, c.cameras[side].rms_px))));
  for (std::size_t p = 0; p < c.views.size(); ++p)
    for (std::size_t i = 0; i < c.views[p][side].residuals.size(); ++i) {
      const Eigen::Vector2d at = place(c.positions[p].corners[side][i]);
      const Eigen::Vector2d tip = at + enlarged * scale * c.views[p][side].residuals[i];
      cv::line(image, fixed(at), fixed(tip), colour(p), 1, cv::LINE_AA, SHIFT);
      dot(image, at, 2, colour(p));
    }
  return image;
}

cv::Mat draw_errors(const CalibrationRun& run, std::size_t side, double& reach_px) {
  constexpr int SIZE = 480, MIDDLE = SIZE / 2, REACH = 220;
  const auto& c = run.calibration;
  double largest = 1e-6;
  for (const auto& views : c.views) largest = std::max(largest, views[side].max_px);
  reach_px = round_down(2.5 * largest);
  while (reach_px < largest) reach_px *= 2;
  cv::Mat image(SIZE, SIZE, CV_8UC3, WHITE);
  cv::line(image, {MIDDLE - REACH, MIDDLE}, {MIDDLE + REACH, MIDDLE}, LINE);
  cv::line(image, {MIDDLE, MIDDLE - REACH}, {MIDDLE, MIDDLE + REACH}, LINE);
  for (std::size_t p = 0; p < c.views.size(); ++p)
    for (const auto& residual : c.views[p][side].residuals)
      dot(image, Eigen::Vector2d(MIDDLE, MIDDLE) + REACH / reach_px * residual, 1.5, colour(p));
  const int sigma = static_cast<int>(REACH / reach_px * c.sigma_px);
  cv::circle(image, {MIDDLE, MIDDLE}, sigma, INK, 1, cv::LINE_AA);
  text(image, fmt::format("{:.3g} px", reach_px), {SIZE - 80, MIDDLE - 8});
  return image;
}

cv::Mat draw_volume_coverage(const CalibrationRun& run, std::size_t side) {
  constexpr int CELL = 56, GAP = 24, TOP = 34;
  const auto& coverage = run.in_volume[side];
  const Eigen::Vector3i cells = coverage.cells.cwiseMin(12);
  const int slice_width = CELL * cells.x();
  cv::Mat image(TOP + CELL * cells.y() + GAP, GAP + cells.z() * (slice_width + GAP), CV_8UC3, WHITE);
  const double near = run.volume.distance_m - run.volume.size_m.z() / 2;
  const double step = run.volume.size_m.z() / coverage.cells.z();
  for (int z = 0; z < cells.z(); ++z) {
    const int left = GAP + z * (slice_width + GAP);
    text(image, fmt::format("{:.1f} - {:.1f} mm", 1e3 * (near + z * step), 1e3 * (near + (z + 1) * step)),
         {left, TOP - 10});
    for (int y = 0; y < cells.y(); ++y)
      for (int x = 0; x < cells.x(); ++x) {
        const cv::Rect cell(left + x * CELL, TOP + y * CELL, CELL, CELL);
        const int count = coverage.at(x, y, z);
        if (count == 0) cv::rectangle(image, cell, EMPTY, cv::FILLED);
        cv::rectangle(image, cell, LINE);
        text(image, std::to_string(count), {cell.x + 8, cell.y + CELL / 2 + 6});
      }
  }
  return image;
}

cv::Mat draw_board_shape(const CalibrationRun& run, double& largest_m) {
  const auto& board = run.views.board;
  const int cell = std::clamp(900 / std::max(1, board.columns), 8, 48);
  cv::Mat image(cell * board.rows, cell * board.columns, CV_8UC3, WHITE);
  const auto nominal = board.points();
  largest_m = 1e-9;
  for (std::size_t i = 0; i < nominal.size(); ++i)
    largest_m = std::max(largest_m, std::abs(run.calibration.rig.points[i].z() - nominal[i].z()));
  for (int r = 0; r < board.rows; ++r)
    for (int c = 0; c < board.columns; ++c) {
      const auto i = static_cast<std::size_t>(r * board.columns + c);
      const double share =
          (run.calibration.rig.points[i].z() - nominal[i].z()) / largest_m;  // z is away from the camera
      const cv::Scalar end = share > 0 ? colour(0) : colour(1);
      cv::rectangle(image, {c * cell, r * cell, cell, cell}, WHITE + std::abs(share) * (end - WHITE), cv::FILLED);
    }
  return image;
}

}  // namespace heartservo::tools
