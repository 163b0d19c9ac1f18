#include "tracking/camera/calibration/board_detection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "tracking/camera/calibration/circle_centres.hpp"

namespace heartservo::tracking {

namespace {

constexpr double SEARCH_SIZE = 960;  // px; larger pictures are searched at about this size first

Corners to_corners(const std::vector<cv::Point2f>& points, double scale) {
  Corners corners;
  // pixel centres: (u + 1/2) scales, not u
  for (const auto& p : points) corners.emplace_back((p.x + 0.5) * scale - 0.5, (p.y + 0.5) * scale - 0.5);
  return corners;
}

bool find_chessboard(const cv::Mat& grey, const cv::Size& size, std::vector<cv::Point2f>& points) {
  return cv::findChessboardCorners(grey, size, points, cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE) ||
         cv::findChessboardCornersSB(grey, size, points, cv::CALIB_CB_NORMALIZE_IMAGE);
}

// Distance to the nearest neighbour in the grid.
double room_px(const Board& board, const Corners& corners, int column, int row) {
  const auto at = [&](int c, int r) { return corners[static_cast<std::size_t>(r * board.columns + c)]; };
  double nearest = 1e9;
  for (int r = std::max(0, row - 1); r <= std::min(board.rows - 1, row + 1); ++r)
    for (int c = std::max(0, column - 1); c <= std::min(board.columns - 1, column + 1); ++c)
      if (c != column || r != row) nearest = std::min(nearest, (at(c, r) - at(column, row)).norm());
  return nearest;
}

// Each corner in a window that reaches at most 0.4 of the way to its nearest neighbour.
bool refine_chessboard(const cv::Mat& grey, const Board& board, Corners& corners) {
  const Corners rough = corners;
  for (int row = 0; row < board.rows; ++row)
    for (int column = 0; column < board.columns; ++column) {
      auto& corner = corners[static_cast<std::size_t>(row * board.columns + column)];
      const double room = room_px(board, rough, column, row);
      const int half = std::clamp(static_cast<int>(0.4 * room), 2, 15);
      std::vector<cv::Point2f> point{{static_cast<float>(corner.x()), static_cast<float>(corner.y())}};
      cv::cornerSubPix(grey, point, {half, half}, {-1, -1},
                       {cv::TermCriteria::EPS | cv::TermCriteria::MAX_ITER, 50, 1e-3});
      corner = {point[0].x, point[0].y};
    }
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (!corners[i].allFinite()) return false;
  return true;
}

bool find_circles(const cv::Mat& grey, const Board& board, BoardDetection& found) {
  const auto spots = dark_spots(grey);
  const cv::Size size(board.columns, board.rows);
  if (spots.size() < board.size()) return false;
  std::vector<cv::Point2f> points;
  if (!cv::findCirclesGrid(spots, size, points, cv::CALIB_CB_SYMMETRIC_GRID, cv::Ptr<cv::FeatureDetector>()) &&
      !cv::findCirclesGrid(spots, size, points, cv::CALIB_CB_SYMMETRIC_GRID | cv::CALIB_CB_CLUSTERING,
                           cv::Ptr<cv::FeatureDetector>()))
    return false;
  const Corners rough = to_corners(points, 1);
  std::vector<double> ratios;
  found.corners.clear();
  for (int row = 0; row < board.rows; ++row)
    for (int column = 0; column < board.columns; ++column) {
      const auto i = static_cast<std::size_t>(row * board.columns + column);
      const double room = room_px(board, rough, column, row);
      DiscMeasurement disc;
      if (!measure_disc(grey, rough[i], room, disc)) return false;
      found.corners.push_back(disc.centre);
    }
  return true;
}

// Diameter over pitch from the areas of the discs and of the cells between their centres.
double disc_ratio(const cv::Mat& grey, const Board& board, const Corners& corners) {
  const auto at = [&](int c, int r) { return corners[static_cast<std::size_t>(r * board.columns + c)]; };
  double discs = 0, cells = 0;
  for (int r = 1; r + 1 < board.rows; ++r)
    for (int c = 1; c + 1 < board.columns; ++c) {
      const Eigen::Vector2d x = 0.5 * (at(c + 1, r) - at(c - 1, r)), y = 0.5 * (at(c, r + 1) - at(c, r - 1));
      DiscMeasurement disc;
      if (!measure_disc(grey, at(c, r), room_px(board, corners, c, r), disc)) continue;
      discs += disc.area_px2;
      cells += std::abs(x.x() * y.y() - x.y() * y.x());
    }
  return cells > 0 ? std::sqrt(4 / M_PI * discs / cells) : 0;
}

std::string reason(const cv::Mat& grey, const Board& board) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(grey, mean, deviation);
  if (mean[0] < 15) return "the picture is dark";
  if (mean[0] > 245) return "the picture is overexposed";
  if (deviation[0] < 6) return "the picture has no contrast";
  return fmt::format("no {} of {} x {} {} found; all of it must be in the picture, sharp, with a light rim",
                     board.kind == BoardKind::CHESSBOARD ? "chessboard" : "board", board.columns, board.rows,
                     board.kind == BoardKind::CHESSBOARD ? "inner corners" : "circles");
}

bool detect_chessboard(const cv::Mat& grey, const Board& board, BoardDetection& found) {
  const cv::Size size(board.columns, board.rows);
  const double scale = std::max(1.0, std::max(grey.cols, grey.rows) / SEARCH_SIZE);
  std::vector<cv::Point2f> points;
  bool done = false;
  if (scale > 1) {
    cv::Mat small;
    cv::resize(grey, small, {}, 1 / scale, 1 / scale, cv::INTER_AREA);
    done = find_chessboard(small, size, points);
    if (done) found.corners = to_corners(points, scale);
  }
  if (!done) {
    if (!find_chessboard(grey, size, points)) return false;
    found.corners = to_corners(points, 1);
  }
  return refine_chessboard(grey, board, found.corners);
}

bool detect_circles(const cv::Mat& grey, const Board& board, BoardDetection& found) {
  cv::Mat picture = grey;
  bool done = find_circles(picture, board, found);
  if (!done) {
    picture = 255 - grey;
    done = find_circles(picture, board, found);
  }
  if (done) found.disc_ratio = disc_ratio(picture, board, found.corners);
  return done;
}

}  // namespace

BoardDetection detect_board(const cv::Mat& grey, const Board& board) {
  BoardDetection found;
  cv::Scalar mean, deviation;
  cv::meanStdDev(grey, mean, deviation);
  if (deviation[0] < 1) {  // not worth a search
    found.problem = reason(grey, board);
    return found;
  }
  try {
    const bool is_there = board.kind == BoardKind::CHESSBOARD ? detect_chessboard(grey, board, found)
                                                              : detect_circles(grey, board, found);
    if (!is_there) {
      found.corners.clear();
      found.problem = reason(grey, board);
      return found;
    }
  } catch (const cv::Exception& e) {
    found.corners.clear();
    found.problem = "OpenCV cannot search this picture: " + e.err;
    return found;
  }
  if (is_mirrored(board, found.corners))  // a detector may number rows from either end
    for (int r = 0; r < board.rows; ++r)
      std::reverse(found.corners.begin() + r * board.columns, found.corners.begin() + (r + 1) * board.columns);
  found.problem = grid_problem(board, found.corners);
  if (!found.problem.empty()) found.corners.clear();
  return found;
}

}  // namespace heartservo::tracking
