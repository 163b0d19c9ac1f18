#pragma once
// How tissue deforms, as a random field: what keeps its stretching apart from its coming nearer (docs/depth.md).
#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include "tracking/depth/depth_options.hpp"

namespace heartservo::tracking {

/// Of points of tissue that appear at `rays` (normalised plane), about `depth_m` away, since the first frame.
struct DeformationPrior {
  Eigen::MatrixXd weight;       ///< inverse covariance (2N x 2N) of where they appear: deformation, and noise
  Eigen::VectorXd with_centre;  ///< covariance (2N) of that with the centre's own way along z, in units of the depth
  Eigen::VectorXd kriging;      ///< weight * with_centre: what the points say of that way
  double centre_variance = 0;   ///< of that way
};

/// Both ways of a point have the covariance 2 sigma^2 exp(-d^2 / 2 l^2) with those of another at the distance d along
/// the surface (2: of two frames that both are deformed). Across means along z here, which moves a point at the ray n by
/// -n bulge / depth. `noise`: standard deviation of a tracked point, normalised plane.
DeformationPrior deformation_prior(const std::vector<Eigen::Vector2d>& rays, const Eigen::Vector2d& centre,
                                   double depth_m, double noise, const DepthOptions& options);

}  // namespace heartservo::tracking
