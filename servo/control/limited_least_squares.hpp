#pragma once
// minimise  |G U - D|^2 + smooth |S U - e0 u_last'|^2   over U (moves x 3, m/s),
// subject to |u_j| <= max_speed and |u_j - u_{j-1}| <= max_change for every move, Euclidean norms of 3-vectors,
//
// where S takes differences and u_last is the velocity before the first move. Without active limits the solution is one
// product; else the alternating direction method of multipliers (Boyd et al. 2011, section 5; the splitting of OSQP,
// Stellato et al. 2020, and its balancing of the penalty) with balls as the sets, started from the last solution.
// Nothing is allocated after the making.
#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace heartservo::servo {

class LimitedLeastSquares {
 public:
  /// G: goals x moves, s; smooth in s^2; limits in m/s.
  LimitedLeastSquares(const Eigen::MatrixXd& G, double smooth, double max_speed, double max_change);

  /// D: goals x 3, m. Returns U, valid until the next call.
  const Eigen::MatrixXd& solve(const Eigen::MatrixXd& D, const Eigen::Vector3d& last);

  /// Of the last solution.
  int iterations() const { return iterations_; }
  /// By how much the last solution breaks a limit, m/s.
  double violation() const { return violation_; }

 private:
  double worst_violation(const Eigen::MatrixXd& U) const;
  void constraints_of(const Eigen::MatrixXd& U, Eigen::MatrixXd& Z) const;
  void project(Eigen::MatrixXd& Z) const;
  void transposed(const Eigen::MatrixXd& X, Eigen::MatrixXd& right) const;
  void balance(double primal, double dual);

  int moves_;
  double smooth_, max_speed_, max_change_, penalty_;
  Eigen::MatrixXd G_, H_, AtA_, K_;
  Eigen::LLT<Eigen::MatrixXd> free_, split_;
  Eigen::MatrixXd q_, U_, Z_, Y_, A_, right_;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
  int iterations_ = 0;
  double violation_ = 0;
};

}  // namespace heartservo::servo
