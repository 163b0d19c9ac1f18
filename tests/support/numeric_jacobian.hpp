#pragma once
#include <Eigen/Core>

namespace heartservo::test {

/// d f / d x at x by central differences. `f` takes a vector of x's size and returns a vector.
template <class Function>
Eigen::MatrixXd numeric_jacobian(const Function& f, const Eigen::VectorXd& x, double step = 1e-6) {
  const Eigen::VectorXd f0 = f(x);
  Eigen::MatrixXd J(f0.size(), x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Eigen::VectorXd up = x, down = x;
    up(i) += step;
    down(i) -= step;
    const Eigen::VectorXd f_up = f(up), f_down = f(down);
    J.col(i) = (f_up - f_down) / (2 * step);
  }
  return J;
}

}  // namespace heartservo::test
