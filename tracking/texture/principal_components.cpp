#include "tracking/texture/principal_components.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace heartservo::tracking {

Eigen::Index PrincipalComponents::components_for(double share) const {
  double sum = 0;
  for (Eigen::Index k = 0; k < explained.size(); ++k)
    if ((sum += explained(k)) >= share - 1e-12) return k + 1;
  return explained.size();
}

Eigen::VectorXd PrincipalComponents::communality(Eigen::Index components) const {
  return loadings.leftCols(components).rowwise().squaredNorm();
}

Eigen::MatrixXd standardised(const Eigen::MatrixXd& samples) {
  Eigen::MatrixXd z = samples.rowwise() - samples.colwise().mean();
  const auto n = static_cast<double>(samples.rows());
  for (Eigen::Index k = 0; k < z.cols(); ++k) z.col(k) /= std::sqrt(z.col(k).squaredNorm() / n);
  return z;
}

PrincipalComponents principal_components(const Eigen::MatrixXd& z) {
  const Eigen::MatrixXd correlation = z.transpose() * z / static_cast<double>(z.rows());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(correlation);
  PrincipalComponents result;
  const Eigen::VectorXd variance = solver.eigenvalues().reverse().cwiseMax(0);
  result.explained = variance / variance.sum();
  result.loadings = solver.eigenvectors().rowwise().reverse() * variance.cwiseSqrt().asDiagonal();
  for (Eigen::Index k = 0; k < result.loadings.cols(); ++k) {
    Eigen::Index largest = 0;
    result.loadings.col(k).cwiseAbs().maxCoeff(&largest);
    if (result.loadings(largest, k) < 0) result.loadings.col(k) *= -1;
  }
  return result;
}

}  // namespace heartservo::tracking
