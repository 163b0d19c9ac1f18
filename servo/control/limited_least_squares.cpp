#include "servo/control/limited_least_squares.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::servo {

namespace {

constexpr int kMostIterations = 600;
constexpr int kBalanceEvery = 15;
constexpr double kTolerance = 5e-6;  // m/s

}  // namespace

LimitedLeastSquares::LimitedLeastSquares(const Eigen::MatrixXd& G, double smooth, double max_speed, double max_change)
    : moves_(static_cast<int>(G.cols())), smooth_(smooth), max_speed_(max_speed), max_change_(max_change), G_(G) {
  Eigen::MatrixXd S = Eigen::MatrixXd::Identity(moves_, moves_);
  for (int j = 1; j < moves_; ++j) S(j, j - 1) = -1;
  H_ = G.transpose() * G + smooth * S.transpose() * S;
  AtA_ = Eigen::MatrixXd::Identity(moves_, moves_) + S.transpose() * S;
  free_.compute(H_);
  penalty_ = 0.1 * H_.trace() / moves_;
  K_ = H_ + penalty_ * AtA_;
  split_.compute(K_);
  for (auto* m : {&q_, &U_, &right_}) m->setZero(moves_, 3);
  for (auto* m : {&Z_, &Y_, &A_}) m->setZero(2 * moves_, 3);
}

// The upper half of Z are the velocities, the lower half their changes.
void LimitedLeastSquares::constraints_of(const Eigen::MatrixXd& U, Eigen::MatrixXd& Z) const {
  Z.topRows(moves_) = U;
  Z.row(moves_) = U.row(0) - last_.transpose();
  for (int j = 1; j < moves_; ++j) Z.row(moves_ + j) = U.row(j) - U.row(j - 1);
}

void LimitedLeastSquares::project(Eigen::MatrixXd& Z) const {
  for (int i = 0; i < 2 * moves_; ++i) {
    const double most = i < moves_ ? max_speed_ : max_change_, length = Z.row(i).norm();
    if (length > most) Z.row(i) *= most / length;
  }
}

// right = A' X.
void LimitedLeastSquares::transposed(const Eigen::MatrixXd& X, Eigen::MatrixXd& right) const {
  right = X.topRows(moves_) + X.bottomRows(moves_);
  right.topRows(moves_ - 1) -= X.bottomRows(moves_ - 1);
}

// A penalty at which both residuals shrink alike.
void LimitedLeastSquares::balance(double primal, double dual) {
  const double factor = std::clamp(std::sqrt(primal / std::max(1e-15, dual)), 0.1, 10.0);
  if (factor > 0.5 && factor < 2) return;
  penalty_ *= factor;
  Y_ /= factor;
  K_ = H_ + penalty_ * AtA_;
  split_.compute(K_);
}

double LimitedLeastSquares::worst_violation(const Eigen::MatrixXd& U) const {
  double worst = 0;
  for (int j = 0; j < moves_; ++j) {
    const double change = j == 0 ? (U.row(0) - last_.transpose()).norm() : (U.row(j) - U.row(j - 1)).norm();
    worst = std::max({worst, U.row(j).norm() - max_speed_, change - max_change_});
  }
  return worst;
}

const Eigen::MatrixXd& LimitedLeastSquares::solve(const Eigen::MatrixXd& D, const Eigen::Vector3d& last) {
  last_ = last;
  q_.noalias() = G_.transpose().lazyProduct(D);
  q_.row(0) += smooth_ * last.transpose();
  right_ = q_;
  free_.solveInPlace(right_);
  iterations_ = 0;
  violation_ = worst_violation(right_);
  if (violation_ <= kTolerance) {
    U_ = right_;
    constraints_of(U_, Z_);
    Y_.setZero();
    return U_;
  }
  // Z = A U + a0 with a0 = -last in the first change; Y are the scaled multipliers.
  for (; iterations_ < kMostIterations; ++iterations_) {
    A_ = Z_ - Y_;
    A_.row(moves_) += last.transpose();
    transposed(A_, right_);
    right_ = q_ + penalty_ * right_;
    split_.solveInPlace(right_);
    U_ = right_;
    constraints_of(U_, A_);
    A_ += Y_;
    Z_.swap(A_);  // A_: the old Z; Z_: A U + Y
    Y_ = Z_;
    project(Z_);
    Y_ -= Z_;
    A_ -= Z_;
    const double moved = A_.cwiseAbs().maxCoeff();
    violation_ = worst_violation(U_);
    if (violation_ < kTolerance && moved < kTolerance) break;
    if (iterations_ % kBalanceEvery == kBalanceEvery - 1) {
      transposed(A_, right_);
      const double dual = penalty_ * right_.norm();
      constraints_of(U_, A_);
      A_ -= Z_;
      const double primal = A_.norm() / std::max(1e-12, Z_.norm());
      transposed(Y_, right_);
      balance(primal, dual / std::max(1e-15, penalty_ * right_.norm()));
    }
  }
  return U_;
}

}  // namespace heartservo::servo
