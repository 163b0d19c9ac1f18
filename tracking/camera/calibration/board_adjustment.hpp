#pragma once
// Least squares over everything a calibration has: cameras, where they stand to each other, board poses, and the
// board's own shape.
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "tracking/camera/calibration/board.hpp"
#include "tracking/camera/camera.hpp"

namespace heartservo::tracking {

/// The board at one place, as one or two cameras saw it (left first).
struct BoardPosition {
  std::array<std::string, 2> names;  ///< of the pictures or lists
  std::array<Corners, 2> corners;    ///< px; empty: not seen; a corner that is not finite is left out
};

/// Everything that is estimated.
struct BoardRig {
  std::vector<Camera> cameras;                                     ///< one, or left and right
  Eigen::Isometry3d T_right_left = Eigen::Isometry3d::Identity();  ///< m; for two cameras
  std::vector<Eigen::Isometry3d> T_left_board;                     ///< one a position
  std::vector<Eigen::Vector3d> points;                             ///< of the board, m
};

/// T_camera_board of one side at one position.
inline Eigen::Isometry3d board_pose(const BoardRig& rig, std::size_t position, std::size_t side) {
  const Eigen::Isometry3d& T_left_board = rig.T_left_board[position];
  return side == 0 ? T_left_board : Eigen::Isometry3d(rig.T_right_left * T_left_board);
}

/// What may change. Poses of the board always do.
struct FreeParts {
  bool cameras = true;  ///< and T_right_left
  bool points = false;  ///< the board's shape; its place, orientation and size stay (sums over the points of the moves,
                        ///< of the moments and of the radial moves are 0)
};

struct BoardAdjustment {
  BoardRig rig;
  double sum_of_squares_px2 = 0;  ///< infinite when the start has no picture
  int degrees_of_freedom = 0;     ///< measured numbers less unknowns
  bool converged = false;
  /// Inverse of the information about the eight parameters of each camera (camera_jacobian.hpp) and the twist of
  /// T_right_left (v in m, w in rad), everything else being unknown too, for corners of unit variance: times sigma^2 it
  /// is their covariance. Where the pictures say nothing about a parameter its variance is huge or infinite.
  Eigen::MatrixXd inverse_information;
};

/// Levenberg-Marquardt from `start` (points at the board's nominal places); positions are eliminated one by one (Schur
/// complement), so that many cost little. `start` must have positive depths.
BoardAdjustment adjust_board_rig(const BoardRig& start, const std::vector<BoardPosition>& positions,
                                 const FreeParts& free);

/// Measured less computed corners (px) of one side at one position; empty where it did not see the board, NaN where a
/// corner is left out.
Corners board_residuals(const BoardRig& rig, const std::vector<BoardPosition>& positions, std::size_t position,
                        std::size_t side);

}  // namespace heartservo::tracking
