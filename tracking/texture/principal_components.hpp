#pragma once
// Principal component analysis of a table of samples.
#include <Eigen/Core>

namespace heartservo::tracking {

struct PrincipalComponents {
  Eigen::VectorXd explained;  ///< share of the total variance, descending; as many as features
  Eigen::MatrixXd loadings;   ///< features x components: correlation of each feature with each component

  /// Components that together explain at least `share` of the variance.
  Eigen::Index components_for(double share) const;
  /// Share of each feature's variance that the first `components` explain (communality).
  Eigen::VectorXd communality(Eigen::Index components) const;
};

/// Each column to mean 0 and standard deviation 1 (of n samples). Columns must not be constant.
Eigen::MatrixXd standardised(const Eigen::MatrixXd& samples);

/// `z`: samples x features, standardised. Signs: each component's largest loading is positive.
PrincipalComponents principal_components(const Eigen::MatrixXd& z);

}  // namespace heartservo::tracking
