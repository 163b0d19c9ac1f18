#include "tracking/camera/calibration/board_equations.hpp"

#include <cmath>
#include <limits>

#include "tracking/camera/camera_jacobian.hpp"

namespace heartservo::tracking {

namespace {

constexpr double INFINITE = std::numeric_limits<double>::infinity();

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

Eigen::Vector3d in_camera(const BoardRig& rig, std::size_t position, std::size_t side, std::size_t i) {
  const Eigen::Vector3d left = rig.T_left_board[position] * rig.points[i];
  return side == 0 ? left : rig.T_right_left * left;
}

}  // namespace

BoardUnknowns::BoardUnknowns(const BoardRig& start, const FreeParts& free) {
  const int count = static_cast<int>(start.cameras.size());
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
    size += 3 * static_cast<int>(start.points.size());
  }
}

BoardNormalEquations::BoardNormalEquations(int shared, std::size_t positions)
    : A(Eigen::MatrixXd::Zero(shared, shared)),
      g(Eigen::VectorXd::Zero(shared)),
      B(positions, Eigen::MatrixXd::Zero(shared, 6)),
      D(positions, Matrix6::Zero()),
      e(positions, Vector6::Zero()) {}

BoardEquations::BoardEquations(const BoardRig& start, const std::vector<BoardPosition>& positions,
                               const FreeParts& free)
    : positions_(positions), sides_(start.cameras.size()), unknowns_(start, free), nominal_(start.points) {
  if (unknowns_.points >= 0) make_gauge();
}

int BoardEquations::degrees_of_freedom() const {
  int measured = 0;
  for (const auto& position : positions_)
    for (std::size_t side = 0; side < sides_; ++side)
      for (const auto& corner : position.corners[side]) measured += corner.allFinite() ? 2 : 0;
  return measured - unknowns_.size - 6 * static_cast<int>(positions_.size()) + (unknowns_.points >= 0 ? 7 : 0);
}

double BoardEquations::cost(const BoardRig& rig) const {
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

double BoardEquations::gauge_cost(const BoardRig& rig) const {
  return unknowns_.points < 0 ? 0 : gauge_weight_ * (gauge_ * moves(rig)).squaredNorm();
}

BoardNormalEquations BoardEquations::at(const BoardRig& rig) {
  BoardNormalEquations n(unknowns_.size, positions_.size());
  for (std::size_t p = 0; p < positions_.size(); ++p)
    for (std::size_t side = 0; side < rig.cameras.size(); ++side)
      for (std::size_t i = 0; i < positions_[p].corners[side].size(); ++i)
        if (positions_[p].corners[side][i].allFinite()) add(n, rig, p, side, i);
  if (unknowns_.points >= 0) add_gauge(n, rig);
  return n;
}

BoardRig BoardEquations::stepped(const BoardRig& rig, const Eigen::VectorXd& shared,
                                 const std::vector<Vector6>& poses) const {
  BoardRig next = rig;
  if (unknowns_.cameras >= 0)
    for (std::size_t c = 0; c < rig.cameras.size(); ++c)
      next.cameras[c] = with_parameters(
          rig.cameras[c], parameters_of(rig.cameras[c]) + shared.segment<8>(unknowns_.cameras + 8 * int(c)));
  if (unknowns_.rig >= 0) next.T_right_left = moved(rig.T_right_left, shared.segment<6>(unknowns_.rig));
  if (unknowns_.points >= 0)
    for (std::size_t i = 0; i < rig.points.size(); ++i)
      next.points[i] += shared.segment<3>(unknowns_.points + 3 * int(i));
  for (std::size_t p = 0; p < poses.size(); ++p) next.T_left_board[p] = moved(rig.T_left_board[p], poses[p]);
  return next;
}

void BoardEquations::add(BoardNormalEquations& n, const BoardRig& rig, std::size_t p, std::size_t side,
                         std::size_t i) const {
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
  if (unknowns_.cameras >= 0)
    put(unknowns_.cameras + 8 * static_cast<int>(side), parameter_jacobian(camera, X.hnormalized()));
  if (unknowns_.rig >= 0 && side == 1) {
    Eigen::Matrix<double, 2, 6> J_rig;
    J_rig << J_point, -J_point * skew(R_side * left);
    put(unknowns_.rig, J_rig);
  }
  if (unknowns_.points >= 0) put(unknowns_.points + 3 * static_cast<int>(i), Eigen::Matrix<double, 2, 3>(J_left * R));
  for (int a = 0; a < blocks; ++a) {
    const auto J_a = J.middleCols(offset[a], width[a]);
    n.g.segment(index[a], width[a]) += J_a.transpose() * r;
    n.B[p].middleRows(index[a], width[a]) += J_a.transpose() * J_pose;
    for (int b = 0; b < blocks; ++b)
      n.A.block(index[a], index[b], width[a], width[b]) += J_a.transpose() * J.middleCols(offset[b], width[b]);
  }
}

void BoardEquations::make_gauge() {
  const int count = static_cast<int>(nominal_.size());
  gauge_ = Eigen::MatrixXd::Zero(7, 3 * count);
  for (int i = 0; i < count; ++i) {
    gauge_.block<3, 3>(0, 3 * i).setIdentity();
    gauge_.block<3, 3>(3, 3 * i) = skew(nominal_[static_cast<std::size_t>(i)]);
    gauge_.block<1, 3>(6, 3 * i) = nominal_[static_cast<std::size_t>(i)].transpose();
  }
  gauge_.rowwise().normalize();
}

Eigen::VectorXd BoardEquations::moves(const BoardRig& rig) const {
  Eigen::VectorXd result(3 * static_cast<int>(nominal_.size()));
  for (std::size_t i = 0; i < nominal_.size(); ++i) result.segment<3>(3 * int(i)) = rig.points[i] - nominal_[i];
  return result;
}

void BoardEquations::add_gauge(BoardNormalEquations& n, const BoardRig& rig) {
  auto A = n.A.block(unknowns_.points, unknowns_.points, gauge_.cols(), gauge_.cols());
  if (gauge_weight_ == 0) gauge_weight_ = A.diagonal().mean();
  A += gauge_weight_ * gauge_.transpose() * gauge_;
  n.g.tail(gauge_.cols()) -= gauge_weight_ * gauge_.transpose() * (gauge_ * moves(rig));
}

}  // namespace heartservo::tracking
