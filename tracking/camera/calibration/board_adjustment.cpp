#include "tracking/camera/calibration/board_adjustment.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "tracking/camera/camera_jacobian.hpp"

namespace heartservo::tracking {

namespace {

constexpr int MAX_ITERATIONS = 200;
constexpr double INFINITE = std::numeric_limits<double>::infinity();

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d S;
  S << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return S;
}

// T moved by a small twist: t + v, exp(w) R.
Eigen::Isometry3d moved(const Eigen::Isometry3d& T, const Vector6& twist) {
  Eigen::Isometry3d result = T;
  result.translation() += twist.head<3>();
  const double angle = twist.tail<3>().norm();
  if (angle > 0) result.linear() = Eigen::AngleAxisd(angle, twist.tail<3>() / angle) * T.linear();
  result.linear() = Eigen::Quaterniond(result.linear()).normalized().toRotationMatrix();
  return result;
}

// Where the shared unknowns stand in their vector; -1: not free.
struct Layout {
  int cameras = -1, rig = -1, points = -1, size = 0;

  Layout(const BoardRig& rig_start, const FreeParts& free) {
    const int count = static_cast<int>(rig_start.cameras.size());
    if (free.cameras) {
      cameras = 0;
      size = 8 * count;
      if (count == 2) {
        rig = size;
        size += 6;
      }
    }
    if (free.points) {
      points = size;
      size += 3 * static_cast<int>(rig_start.points.size());
    }
  }
};

// The normal equations: A and g of the shared unknowns, and B, D, e of every position's pose.
struct NormalEquations {
  Eigen::MatrixXd A;
  Eigen::VectorXd g;
  std::vector<Eigen::MatrixXd> B;
  std::vector<Matrix6, Eigen::aligned_allocator<Matrix6>> D;
  std::vector<Vector6, Eigen::aligned_allocator<Vector6>> e;

  NormalEquations(int shared, std::size_t positions)
      : A(Eigen::MatrixXd::Zero(shared, shared)),
        g(Eigen::VectorXd::Zero(shared)),
        B(positions, Eigen::MatrixXd::Zero(shared, 6)),
        D(positions, Matrix6::Zero()),
        e(positions, Vector6::Zero()) {}
};

class Problem {
 public:
  Problem(const BoardRig& start, const std::vector<BoardPosition>& positions, const FreeParts& free)
      : positions_(positions), layout_(start, free), nominal_(start.points) {
    if (layout_.points >= 0) make_gauge();
  }

  const Layout& layout() const { return layout_; }

  // Sum of squares; infinite where a point is behind a camera.
  double cost(const BoardRig& rig) const {
    double sum = 0;
    for (std::size_t p = 0; p < positions_.size(); ++p)
      for (std::size_t side = 0; side < rig.cameras.size(); ++side)
        for (std::size_t i = 0; i < positions_[p].corners[side].size(); ++i) {
          if (!positions_[p].corners[side][i].allFinite()) continue;
          const Eigen::Vector3d X = in_camera(rig, p, side, i);
          if (!(X.z() > 0)) return INFINITE;
          sum += (positions_[p].corners[side][i] - rig.cameras[side].project(X)).squaredNorm();
        }
    return std::isfinite(sum) ? sum : INFINITE;
  }

  // The gauge of the points is free: it costs nothing to keep it, so this is 0 at the minimum.
  double gauge_cost(const BoardRig& rig) const {
    return layout_.points < 0 ? 0 : gauge_weight_ * (gauge_ * moves(rig)).squaredNorm();
  }

  NormalEquations equations(const BoardRig& rig) {
    NormalEquations n(layout_.size, positions_.size());
    for (std::size_t p = 0; p < positions_.size(); ++p)
      for (std::size_t side = 0; side < rig.cameras.size(); ++side)
        for (std::size_t i = 0; i < positions_[p].corners[side].size(); ++i)
          if (positions_[p].corners[side][i].allFinite()) add(n, rig, p, side, i);
    if (layout_.points >= 0) add_gauge(n, rig);
    return n;
  }

  int unknowns() const {
    return layout_.size + 6 * static_cast<int>(positions_.size()) - (layout_.points >= 0 ? 7 : 0);
  }

  BoardRig stepped(const BoardRig& rig, const Eigen::VectorXd& shared, const std::vector<Vector6>& poses) const {
    BoardRig next = rig;
    if (layout_.cameras >= 0)
      for (std::size_t c = 0; c < rig.cameras.size(); ++c)
        next.cameras[c] = with_parameters(
            rig.cameras[c], parameters_of(rig.cameras[c]) + shared.segment<8>(layout_.cameras + 8 * int(c)));
    if (layout_.rig >= 0) next.T_right_left = moved(rig.T_right_left, shared.segment<6>(layout_.rig));
    if (layout_.points >= 0)
      for (std::size_t i = 0; i < rig.points.size(); ++i)
        next.points[i] += shared.segment<3>(layout_.points + 3 * int(i));
    for (std::size_t p = 0; p < poses.size(); ++p) next.T_left_board[p] = moved(rig.T_left_board[p], poses[p]);
    return next;
  }

 private:
  static Eigen::Vector3d in_camera(const BoardRig& rig, std::size_t position, std::size_t side, std::size_t i) {
    const Eigen::Vector3d left = rig.T_left_board[position] * rig.points[i];
    return side == 0 ? left : rig.T_right_left * left;
  }

  void add(NormalEquations& n, const BoardRig& rig, std::size_t p, std::size_t side, std::size_t i) const {
    const Eigen::Matrix3d& R = rig.T_left_board[p].linear();
    const Eigen::Vector3d arm = R * rig.points[i], left = arm + rig.T_left_board[p].translation();
    const Eigen::Matrix3d R_side = side == 0 ? Eigen::Matrix3d::Identity() : Eigen::Matrix3d(rig.T_right_left.linear());
    const Eigen::Vector3d X = in_camera(rig, p, side, i);
    const Camera& camera = rig.cameras[side];
    const Eigen::Matrix<double, 2, 3> J_point = projection_jacobian(camera, X);
    const Eigen::Matrix<double, 2, 3> J_left = J_point * R_side;
    const Eigen::Vector2d r = positions_[p].corners[side][i] - camera.project(X);

    Eigen::Matrix<double, 2, 6> J_pose;
    J_pose << J_left, -J_left * skew(arm);  // d (w x arm) = -[arm]x dw
    n.D[p] += J_pose.transpose() * J_pose;
    n.e[p] += J_pose.transpose() * r;

    Eigen::Matrix<double, 2, 17> J;  // the shared unknowns that this corner depends on, and where they stand
    int index[3], offset[3], width[3], blocks = 0, used = 0;
    const auto put = [&](int where, const auto& block) {
      index[blocks] = where;
      offset[blocks] = used;
      width[blocks++] = static_cast<int>(block.cols());
      J.middleCols(used, block.cols()) = block;
      used += static_cast<int>(block.cols());
    };
    if (layout_.cameras >= 0)
      put(layout_.cameras + 8 * static_cast<int>(side), parameter_jacobian(camera, X.hnormalized()));
    if (layout_.rig >= 0 && side == 1) {
      Eigen::Matrix<double, 2, 6> J_rig;
      J_rig << J_point, -J_point * skew(R_side * left);
      put(layout_.rig, J_rig);
    }
    if (layout_.points >= 0) put(layout_.points + 3 * static_cast<int>(i), Eigen::Matrix<double, 2, 3>(J_left * R));
    for (int a = 0; a < blocks; ++a) {
      const auto J_a = J.middleCols(offset[a], width[a]);
      n.g.segment(index[a], width[a]) += J_a.transpose() * r;
      n.B[p].middleRows(index[a], width[a]) += J_a.transpose() * J_pose;
      for (int b = 0; b < blocks; ++b)
        n.A.block(index[a], index[b], width[a], width[b]) += J_a.transpose() * J.middleCols(offset[b], width[b]);
    }
  }

  // Seven rows over the moves of the points: place, orientation, size.
  void make_gauge() {
    const int count = static_cast<int>(nominal_.size());
    gauge_ = Eigen::MatrixXd::Zero(7, 3 * count);
    for (int i = 0; i < count; ++i) {
      gauge_.block<3, 3>(0, 3 * i).setIdentity();
      gauge_.block<3, 3>(3, 3 * i) = skew(nominal_[static_cast<std::size_t>(i)]);
      gauge_.block<1, 3>(6, 3 * i) = nominal_[static_cast<std::size_t>(i)].transpose();
    }
    gauge_.rowwise().normalize();
  }

  Eigen::VectorXd moves(const BoardRig& rig) const {
    Eigen::VectorXd result(3 * static_cast<int>(nominal_.size()));
    for (std::size_t i = 0; i < nominal_.size(); ++i) result.segment<3>(3 * int(i)) = rig.points[i] - nominal_[i];
    return result;
  }

  void add_gauge(NormalEquations& n, const BoardRig& rig) {
    auto A = n.A.block(layout_.points, layout_.points, gauge_.cols(), gauge_.cols());
    if (gauge_weight_ == 0) gauge_weight_ = A.diagonal().mean();
    A += gauge_weight_ * gauge_.transpose() * gauge_;
    n.g.tail(gauge_.cols()) -= gauge_weight_ * gauge_.transpose() * (gauge_ * moves(rig));
  }

  const std::vector<BoardPosition>& positions_;
  Layout layout_;
  std::vector<Eigen::Vector3d> nominal_;
  Eigen::MatrixXd gauge_;
  double gauge_weight_ = 0;
};

// S = A - sum B D^-1 B' with damped diagonals, and the right-hand side.
void reduce(const NormalEquations& n, double lambda, Eigen::MatrixXd& S, Eigen::VectorXd& s) {
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

Eigen::MatrixXd inverse_information(const NormalEquations& n, int wanted) {
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
  Problem problem(start, positions, free);
  BoardAdjustment result;
  result.rig = start;
  result.sum_of_squares_px2 = problem.cost(start);
  int measured = 0;
  for (const auto& position : positions)
    for (std::size_t side = 0; side < start.cameras.size(); ++side)
      for (const auto& corner : position.corners[side]) measured += corner.allFinite() ? 2 : 0;
  result.degrees_of_freedom = measured - problem.unknowns();
  const int wanted = problem.layout().points >= 0 ? problem.layout().points : problem.layout().size;
  result.inverse_information = Eigen::MatrixXd::Constant(wanted, wanted, INFINITE);
  if (!std::isfinite(result.sum_of_squares_px2)) return result;

  double lambda = 1e-4;
  NormalEquations n = problem.equations(start);
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
    n = problem.equations(result.rig);
    if (result.converged) break;
  }
  if (wanted > 0) result.inverse_information = inverse_information(n, wanted);
  return result;
}

Corners board_residuals(const BoardRig& rig, const std::vector<BoardPosition>& positions, std::size_t position,
                        std::size_t side) {
  Corners residuals;
  const Corners& measured = positions[position].corners[side];
  for (std::size_t i = 0; i < measured.size(); ++i) {
    Eigen::Vector3d X = rig.T_left_board[position] * rig.points[i];
    if (side == 1) X = rig.T_right_left * X;
    residuals.push_back(measured[i] - rig.cameras[side].project(X));
  }
  return residuals;
}

}  // namespace heartservo::tracking
