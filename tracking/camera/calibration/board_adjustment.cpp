#include "tracking/camera/calibration/board_adjustment.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "tracking/camera/calibration/board_equations.hpp"

namespace heartservo::tracking {

namespace {

constexpr int MAX_ITERATIONS = 200;
constexpr double INFINITE = std::numeric_limits<double>::infinity();

// S = A - sum B D^-1 B' with damped diagonals, and the right-hand side.
void reduce(const BoardNormalEquations& n, double lambda, Eigen::MatrixXd& S, Eigen::VectorXd& s) {
  S = n.A;
  S.diagonal() *= 1 + lambda;
  s = n.g;
  for (std::size_t p = 0; p < n.D.size(); ++p) {
    Matrix6 D = n.D[p];
    D.diagonal() *= 1 + lambda;
    const Eigen::LDLT<Matrix6> solver(D);
    S -= n.B[p] * solver.solve(n.B[p].transpose());
    s -= n.B[p] * solver.solve(n.e[p]);
  }
}

// S^-1 b with the diagonal scaled to 1: metres, px and pure numbers differ by orders of magnitude.
Eigen::MatrixXd solve_scaled(const Eigen::MatrixXd& S, const Eigen::VectorXd& scale, const Eigen::MatrixXd& b) {
  const Eigen::MatrixXd scaled = scale.asDiagonal() * S * scale.asDiagonal();
  return scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * b);
}

Eigen::VectorXd scale_of(const Eigen::MatrixXd& A) { return A.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse(); }

Eigen::MatrixXd inverse_information(const BoardNormalEquations& n, int wanted) {
  Eigen::MatrixXd S;
  Eigen::VectorXd s;
  reduce(n, 0, S, s);
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(S.rows(), wanted);
  Eigen::MatrixXd inverse = solve_scaled(S, scale_of(n.A), unit).topRows(wanted);
  inverse = (0.5 * (inverse + inverse.transpose())).eval();
  for (int i = 0; i < wanted; ++i)  // what rounding left of a singular matrix
    if (!(inverse(i, i) > 0)) inverse(i, i) = INFINITE;
  return inverse;
}

}  // namespace

BoardAdjustment adjust_board_rig(const BoardRig& start, const std::vector<BoardPosition>& positions,
                                 const FreeParts& free) {
  BoardEquations problem(start, positions, free);
  BoardAdjustment result;
  result.rig = start;
  result.sum_of_squares_px2 = problem.cost(start);
  result.degrees_of_freedom = problem.degrees_of_freedom();
  const int wanted = problem.unknowns().points >= 0 ? problem.unknowns().points : problem.unknowns().size;
  result.inverse_information = Eigen::MatrixXd::Constant(wanted, wanted, INFINITE);
  if (!std::isfinite(result.sum_of_squares_px2)) return result;

  double lambda = 1e-4;
  BoardNormalEquations n = problem.at(start);
  double total = result.sum_of_squares_px2 + problem.gauge_cost(start);
  Eigen::MatrixXd S;
  Eigen::VectorXd s;
  for (int iteration = 0; iteration < MAX_ITERATIONS && lambda < 1e12; ++iteration) {
    reduce(n, lambda, S, s);
    const Eigen::VectorXd shared = solve_scaled(S, scale_of(n.A), s);
    std::vector<Vector6> poses(positions.size());
    for (std::size_t p = 0; p < positions.size(); ++p) {
      Matrix6 D = n.D[p];
      D.diagonal() *= 1 + lambda;
      poses[p] = D.ldlt().solve(n.e[p] - n.B[p].transpose() * shared);
    }
    const BoardRig next = problem.stepped(result.rig, shared, poses);
    const double next_cost = problem.cost(next), next_total = next_cost + problem.gauge_cost(next);
    if (!(next_total < total)) {
      // the decrease that the step promised is below what the sum can show: this is the minimum
      double promised = shared.dot(n.g);
      for (std::size_t p = 0; p < positions.size(); ++p) promised += poses[p].dot(n.e[p]);
      if (promised <= 1e-13 * total + 1e-20) {
        result.converged = true;
        break;
      }
      lambda *= 10;
      continue;
    }
    result.converged = total - next_total <= 1e-13 * total;
    result.rig = next;
    result.sum_of_squares_px2 = next_cost;
    total = next_total;
    lambda = std::max(lambda * 0.1, 1e-15);
    n = problem.at(result.rig);
    if (result.converged) break;
  }
  if (wanted > 0) result.inverse_information = inverse_information(n, wanted);
  return result;
}

Corners board_residuals(const BoardRig& rig, const std::vector<BoardPosition>& positions, std::size_t position,
                        std::size_t side) {
  Corners residuals;
  const Corners& measured = positions[position].corners[side];
  const Eigen::Isometry3d T_camera_board = board_pose(rig, position, side);
  for (std::size_t i = 0; i < measured.size(); ++i)
    residuals.push_back(measured[i] - rig.cameras[side].project(T_camera_board * rig.points[i]));
  return residuals;
}

}  // namespace heartservo::tracking
