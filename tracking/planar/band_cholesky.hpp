#pragma once
#include <Eigen/Core>

namespace heartservo::tracking {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Solves A x = b for a symmetric positive definite A that is 0 further than `band` left of its diagonal, but for its
/// last row. Only the lower triangle of A is looked at; it becomes the Cholesky factor, and b the solution. False, with
/// A and b spoilt, where A is not positive definite.
bool solve_banded(RowMatrix& A, int band, Eigen::VectorXd& b);

}  // namespace heartservo::tracking
