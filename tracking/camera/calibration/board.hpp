#pragma once
// The calibration board: a flat grid of points. Board frame: origin at the grid's centre, x along a row, y down the
// columns, z away from a camera that sees it from the front. Points row by row.
#include <Eigen/Core>
#include <string>
#include <vector>

namespace heartservo::tracking {

enum class BoardKind { CHESSBOARD, CIRCLES };

/// Pixels of the board's points in one picture, in the board's order; empty where the board was not seen.
using Corners = std::vector<Eigen::Vector2d>;

struct Board {
  BoardKind kind = BoardKind::CHESSBOARD;
  int columns = 0;     ///< inner corners, or circles, in a row
  int rows = 0;        ///< rows of them
  double pitch_m = 0;  ///< from one to the next
  double disc_m = 0;   ///< diameter of a circle; 0: not known, or a chessboard

  std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::vector<Eigen::Vector3d> points() const;

  /// "14 x 10 chessboard of 3 mm", for people.
  std::string description() const;
};

/// What is wrong with corners that should be a picture of the board, and what to do; "" when they are one: all finite
/// and apart from each other, in the board's order up to perspective and a lens, not mirrored. Never throws.
std::string grid_problem(const Board& board, const Corners& corners);

/// True when the grid is seen mirrored: columns to the right, rows upward.
bool is_mirrored(const Board& board, const Corners& corners);

/// Ways to number the board's points that look the same to a detector: turned by 180 degrees, and by 90 and 270 where
/// there are as many columns as rows. The first is the identity; result[k][i] is the old number of the new point i.
std::vector<std::vector<std::size_t>> same_looking_orders(const Board& board);

Corners reordered(const Corners& corners, const std::vector<std::size_t>& order);

/// The order of same_looking_orders() in which the rows of `corners` run most nearly as those of `reference`.
std::size_t order_like(const Board& board, const Corners& corners, const Corners& reference);

/// Median distance of neighbours along rows and columns, px.
double grid_pitch_px(const Board& board, const Corners& corners);

}  // namespace heartservo::tracking
