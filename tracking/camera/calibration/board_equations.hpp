#pragma once
// The normal equations of board_adjustment.hpp: unknowns shared by all views (cameras, rig, the board's points) and the
// pose of each view.
#include <Eigen/Geometry>
#include <vector>

#include "tracking/camera/calibration/board_adjustment.hpp"

namespace heartservo::tracking {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Where the shared unknowns stand in their vector; -1: not free.
struct BoardUnknowns {
  int cameras = -1, rig = -1, points = -1, size = 0;

  BoardUnknowns(const BoardRig& start, const FreeParts& free);
};

/// A and g of the shared unknowns, and B, D, e of every position's pose.
struct BoardNormalEquations {
  Eigen::MatrixXd A;
  Eigen::VectorXd g;
  std::vector<Eigen::MatrixXd> B;
  std::vector<Matrix6, Eigen::aligned_allocator<Matrix6>> D;
  std::vector<Vector6, Eigen::aligned_allocator<Vector6>> e;

  BoardNormalEquations(int shared, std::size_t positions);
};

class BoardEquations {
 public:
  /// `start` has the board's points at their nominal places; `positions` must outlive this.
  BoardEquations(const BoardRig& start, const std::vector<BoardPosition>& positions, const FreeParts& free);

  const BoardUnknowns& unknowns() const { return unknowns_; }
  int degrees_of_freedom() const;  ///< numbers measured less unknowns

  /// Sum of squares, px^2; infinite where a point is behind a camera.
  double cost(const BoardRig& rig) const;

  /// The place, orientation and size of free points cost nothing to keep, so this is 0 at the minimum.
  double gauge_cost(const BoardRig& rig) const;

  BoardNormalEquations at(const BoardRig& rig);

  BoardRig stepped(const BoardRig& rig, const Eigen::VectorXd& shared, const std::vector<Vector6>& poses) const;

 private:
  void add(BoardNormalEquations& n, const BoardRig& rig, std::size_t position, std::size_t side, std::size_t i) const;
  void make_gauge();
  Eigen::VectorXd moves(const BoardRig& rig) const;
  void add_gauge(BoardNormalEquations& n, const BoardRig& rig);

  const std::vector<BoardPosition>& positions_;
  std::size_t sides_;
  BoardUnknowns unknowns_;
  std::vector<Eigen::Vector3d> nominal_;
  Eigen::MatrixXd gauge_;  // seven rows over the moves of the points: place, orientation, size
  double gauge_weight_ = 0;
};

}  // namespace heartservo::tracking
