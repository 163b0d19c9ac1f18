#include "tracking/camera/calibration/board.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "tracking/camera/calibration/plane_homography.hpp"

namespace heartservo::tracking {

namespace {

std::size_t at(const Board& board, int column, int row) {
  return static_cast<std::size_t>(row * board.columns + column);
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Mean direction of a row, and of a column, from one end to the other.
Eigen::Vector2d row_direction(const Board& b, const Corners& c) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int r = 0; r < b.rows; ++r) sum += c[at(b, b.columns - 1, r)] - c[at(b, 0, r)];
  return sum.normalized();
}

Eigen::Vector2d column_direction(const Board& b, const Corners& c) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int k = 0; k < b.columns; ++k) sum += c[at(b, k, b.rows - 1)] - c[at(b, k, 0)];
  return sum.normalized();
}

double smallest_distance(const Corners& corners) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) smallest = std::min(smallest, (corners[i] - corners[j]).squaredNorm());
  return std::sqrt(smallest);
}

// Root mean square distance from the grid that fits best, in units of `distance_px`; infinite where none does.
double misfit(const Board& board, const Corners& corners, double distance_px) {
  const auto points = board.points();
  const auto H = plane_homography(points, corners);
  if (!H) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i)
    sum += ((*H * Eigen::Vector3d(points[i].x(), points[i].y(), 1)).hnormalized() - corners[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(corners.size())) / distance_px;
}

}  // namespace

std::vector<Eigen::Vector3d> Board::points() const {
  std::vector<Eigen::Vector3d> result;
  result.reserve(size());
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      result.emplace_back(pitch_m * (c - 0.5 * (columns - 1)), pitch_m * (r - 0.5 * (rows - 1)), 0);
  return result;
}

std::string Board::description() const {
  return fmt::format("{} of {} x {} {}, {:.4g} mm apart", kind == BoardKind::CHESSBOARD ? "chessboard" : "board",
                     columns, rows, kind == BoardKind::CHESSBOARD ? "inner corners" : "circles", 1e3 * pitch_m);
}

std::string grid_problem(const Board& board, const Corners& corners) {
  constexpr double CLOSEST_PX = 2;         // points nearer to each other are the same point twice
  constexpr double LARGEST_MISFIT = 0.35;  // of a pitch; a strong lens bends a board by less
  constexpr double SMALLEST_SINE = 0.05;   // of the angle between rows and columns
  if (corners.size() != board.size())
    return fmt::format("has {} corners, a board of {} x {} has {}", corners.size(), board.columns, board.rows,
                       board.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (!corners[i].allFinite()) return fmt::format("corner {} is not finite", i + 1);
  const double distance = smallest_distance(corners);
  if (distance < CLOSEST_PX)
    return fmt::format("two corners are {:.2g} px apart; the board is too far away or seen from its edge", distance);
  if (!(misfit(board, corners, distance) < LARGEST_MISFIT)) {
    Board turned = board;
    std::swap(turned.columns, turned.rows);
    const bool swapped = misfit(turned, corners, distance) < LARGEST_MISFIT;
    return fmt::format("the corners are no grid of {} columns and {} rows, row by row{}", board.columns, board.rows,
                       swapped ? fmt::format("; they are one of --columns {} --rows {}", turned.columns, turned.rows)
                               : "; check --columns, --rows and the order of the corners");
  }
  if (std::abs(cross(row_direction(board, corners), column_direction(board, corners))) < SMALLEST_SINE)
    return "rows and columns run the same way; the board is seen from its edge";
  if (is_mirrored(board, corners))
    return "the order of the corners is mirrored: seen from its front, rows must run to the right when the next row is "
           "below; turn the order of every row around";
  return "";
}

bool is_mirrored(const Board& board, const Corners& corners) {
  return cross(row_direction(board, corners), column_direction(board, corners)) < 0;
}

std::vector<std::vector<std::size_t>> same_looking_orders(const Board& board) {
  const int turns = board.columns == board.rows ? 4 : 2;
  std::vector<std::vector<std::size_t>> orders;
  for (int turn = 0; turn < turns; ++turn) {
    const int quarter = turns == 4 ? turn : 2 * turn;
    std::vector<std::size_t> order;
    for (int r = 0; r < board.rows; ++r)
      for (int c = 0; c < board.columns; ++c) {
        const int last_c = board.columns - 1, last_r = board.rows - 1;
        const int column = quarter == 0 ? c : quarter == 1 ? last_c - r : quarter == 2 ? last_c - c : r;
        const int row = quarter == 0 ? r : quarter == 1 ? c : quarter == 2 ? last_r - r : last_r - c;
        order.push_back(at(board, column, row));
      }
    orders.push_back(std::move(order));
  }
  return orders;
}

Corners reordered(const Corners& corners, const std::vector<std::size_t>& order) {
  Corners result;
  result.reserve(corners.size());
  for (const std::size_t i : order) result.push_back(corners[i]);
  return result;
}

std::size_t order_like(const Board& board, const Corners& corners, const Corners& reference) {
  const auto orders = same_looking_orders(board);
  const Eigen::Vector2d row = row_direction(board, reference), column = column_direction(board, reference);
  std::size_t best = 0;
  double best_agreement = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < orders.size(); ++k) {
    const Corners turned = reordered(corners, orders[k]);
    const double agreement = row_direction(board, turned).dot(row) + column_direction(board, turned).dot(column);
    if (agreement <= best_agreement) continue;
    best_agreement = agreement;
    best = k;
  }
  return best;
}

double grid_pitch_px(const Board& board, const Corners& corners) {
  std::vector<double> distances;
  for (int r = 0; r < board.rows; ++r)
    for (int c = 0; c < board.columns; ++c) {
      if (c > 0) distances.push_back((corners[at(board, c, r)] - corners[at(board, c - 1, r)]).norm());
      if (r > 0) distances.push_back((corners[at(board, c, r)] - corners[at(board, c, r - 1)]).norm());
    }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

}  // namespace heartservo::tracking
