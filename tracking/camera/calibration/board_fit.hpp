#pragma once
// The steps of a calibration: flat board, circles as discs, gross errors, the board's own shape.
#include <cstddef>
#include <utility>
#include <vector>

#include "tracking/camera/calibration/board_adjustment.hpp"

namespace heartservo::tracking {

/// No detector is better (px); where residuals are smaller they say nothing about certainty.
inline constexpr double BEST_CORNER_PX = 0.02;

class BoardFit {
 public:
  /// `positions` hold at least three views a side.
  BoardFit(const Board& board, int width, int height, std::size_t sides, const std::vector<BoardPosition>& positions);

  /// The board as printed. Throws InputError where nothing fits, and for pairs that do not belong together.
  void fit_flat();

  /// From there, the board's points where the pictures have them. Returns the F ratio of this fit against the flat one:
  /// about 1 where the board is as printed.
  double fit_free();

  const BoardAdjustment& best() const { return best_; }

  /// Corners as measured, centres of discs corrected; and the same with those left out not finite.
  const std::vector<BoardPosition>& corrected() const { return corrected_; }
  const std::vector<BoardPosition>& used() const { return used_; }

  /// A corner's standard deviation in u and in v, as the residuals show it.
  double sigma_px() const;

  /// RMS of both cameras in one rig over that of each alone, for the flat board.
  double pair_strain() const { return pair_strain_; }

 private:
  // Corners that a detector put elsewhere, or that a list has wrong, against the others of their view.
  void leave_out_gross_errors(const FreeParts& free);
  bool choose_corners();  // true if the choice changed
  void correct_discs(const FreeParts& free);

  // A detector numbers a board from either end: views that fit the shape found better the other way round are turned.
  // True if any was.
  bool renumber();
  // Sum of squares of position p with its points in another order and its pose fitted to that, and the pose.
  std::pair<double, Eigen::Isometry3d> cost_of(std::size_t p, const std::vector<std::size_t>& order,
                                               const std::vector<std::size_t>& identity,
                                               const std::vector<Eigen::Vector3d>& nominal) const;

  Board board_;
  int width_, height_;
  std::size_t sides_;
  std::vector<BoardPosition> measured_, corrected_, used_;
  BoardAdjustment best_;
  double pair_strain_ = 1;
};

}  // namespace heartservo::tracking
