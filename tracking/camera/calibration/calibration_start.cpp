#include "tracking/camera/calibration/calibration_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracking/camera/calibration/plane_homography.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

Camera first_camera(int width, int height, double focal) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  return camera;
}

// The focal length that the perspective shows, then such as lenses have.
std::vector<double> focal_candidates(const std::vector<Eigen::Vector3d>& points,
                                     const std::vector<BoardPosition>& positions, int width, int height) {
  std::vector<Eigen::Matrix3d> homographies;
  for (const auto& position : positions)
    if (const auto H = plane_homography(points, position.corners[0])) homographies.push_back(*H);
  std::vector<double> result;
  if (const auto f = focal_length(homographies, width, height)) result.push_back(*f);
  for (const double factor : {1.0, 2.0, 0.5}) result.push_back(factor * std::max(width, height));
  return result;
}

double rms(const BoardAdjustment& a, const std::vector<BoardPosition>& positions) {
  double count = 0;
  for (const auto& position : positions)
    for (const auto& corners : position.corners) count += static_cast<double>(corners.size());
  return std::sqrt(a.sum_of_squares_px2 / count);
}

double difference(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double length_m) {
  return (a.translation() - b.translation()).norm() / length_m +
         Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle();
}

}  // namespace

BoardAdjustment calibrate_one_camera(const Board& board, int width, int height,
                                     const std::vector<BoardPosition>& all_positions, std::size_t side) {
  std::vector<BoardPosition> positions;  // of this side, as if it were the left one
  std::vector<std::size_t> numbers;
  for (std::size_t p = 0; p < all_positions.size(); ++p) {
    if (all_positions[p].corners[side].empty()) continue;
    positions.push_back({{all_positions[p].names[side], ""}, {all_positions[p].corners[side], {}}});
    numbers.push_back(p);
  }
  BoardAdjustment best;
  best.sum_of_squares_px2 = std::numeric_limits<double>::infinity();
  const auto points = board.points();
  const double good_px = 0.5 + 1e-3 * std::max(width, height);  // a minimum that is surely the right one
  for (const double focal : focal_candidates(points, positions, width, height)) {
    BoardRig start;
    start.cameras = {first_camera(width, height, focal)};
    start.points = points;
    for (const auto& position : positions) {
      const auto pose = plane_pose(start.cameras[0], points, position.corners[0]);
      if (!pose) throw InputError(position.names[0] + ": the corners are no picture of a board before the camera");
      start.T_left_board.push_back(*pose);
    }
    const auto adjusted = adjust_board_rig(start, positions, {});
    if (adjusted.sum_of_squares_px2 < best.sum_of_squares_px2) best = adjusted;
    if (rms(best, positions) < good_px) break;
  }
  if (!std::isfinite(best.sum_of_squares_px2))
    throw InputError(positions[0].names[0] + ": no camera fits the corners of these views; check the board's size");
  std::vector<Eigen::Isometry3d> poses(all_positions.size(), Eigen::Isometry3d::Identity());
  for (std::size_t k = 0; k < numbers.size(); ++k) poses[numbers[k]] = best.rig.T_left_board[k];
  best.rig.T_left_board = std::move(poses);
  return best;
}

BoardAdjustment calibrate_two_cameras(const Board& board, const BoardAdjustment& left, const BoardAdjustment& right,
                                      const std::vector<BoardPosition>& positions) {
  std::vector<std::size_t> common;
  std::vector<Eigen::Isometry3d> guesses;  // of T_right_left, one a position
  for (std::size_t p = 0; p < positions.size(); ++p) {
    if (positions[p].corners[0].empty() || positions[p].corners[1].empty()) continue;
    common.push_back(p);
    guesses.push_back(right.rig.T_left_board[p] * left.rig.T_left_board[p].inverse());
  }
  if (common.size() < 3)
    throw InputError(
        fmt::format("only {} pairs show the board on both sides; take 3 or more, better 10", common.size()));
  // the guess that the others agree with most
  const double length_m = board.pitch_m * std::max(board.columns, board.rows);
  double least = std::numeric_limits<double>::infinity();
  Eigen::Isometry3d T_right_left = guesses[0];
  for (const auto& guess : guesses) {
    double sum = 0;
    for (const auto& other : guesses) sum += std::min(1.0, difference(guess, other, length_m));
    if (sum >= least) continue;
    least = sum;
    T_right_left = guess;
  }
  BoardRig start;
  start.cameras = {left.rig.cameras[0], right.rig.cameras[0]};
  start.T_right_left = T_right_left;
  start.points = board.points();
  start.T_left_board = left.rig.T_left_board;
  for (std::size_t p = 0; p < positions.size(); ++p)
    if (positions[p].corners[0].empty()) start.T_left_board[p] = T_right_left.inverse() * right.rig.T_left_board[p];
  auto result = adjust_board_rig(start, positions, {});
  if (!std::isfinite(result.sum_of_squares_px2))
    throw InputError("left and right views do not fit together; check that they are given in the same order");
  return result;
}

}  // namespace heartservo::tracking
