#include "tracking/depth/deformation_prior.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace heartservo::tracking {

DeformationPrior deformation_prior(const std::vector<Eigen::Vector2d>& rays, const Eigen::Vector2d& centre,
                                   double depth_m, double noise, const DepthOptions& options) {
  const double length = options.wander_length_m / depth_m;
  const double along = 2 * std::pow(options.wander_sigma_m / depth_m, 2);
  const double across = 2 * std::pow(options.bulge_sigma_m / depth_m, 2);
  const auto alike = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return std::exp(-(a - b).squaredNorm() / (2 * length * length));
  };
  const auto n = static_cast<Eigen::Index>(rays.size());
  DeformationPrior prior;
  prior.with_centre.resize(2 * n);
  prior.centre_variance = across;
  Eigen::MatrixXd covariance = noise * noise * Eigen::MatrixXd::Identity(2 * n, 2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector2d& a = rays[static_cast<std::size_t>(i)];
    prior.with_centre.segment<2>(2 * i) = -across * alike(a, centre) * a;
    for (Eigen::Index j = 0; j < n; ++j) {
      const Eigen::Vector2d& b = rays[static_cast<std::size_t>(j)];
      covariance.block<2, 2>(2 * i, 2 * j) +=
          alike(a, b) * (along * Eigen::Matrix2d::Identity() + across * a * b.transpose());
    }
  }
  prior.weight = covariance.llt().solve(Eigen::MatrixXd::Identity(2 * n, 2 * n));
  prior.kriging = prior.weight * prior.with_centre;
  return prior;
}

}  // namespace heartservo::tracking
