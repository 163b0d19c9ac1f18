#include "tracking/landmark/assumed_depth_estimator.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

AssumedDepthEstimator::AssumedDepthEstimator(const Camera& camera, double depth_m, double corner_sigma_px)
    : camera_(camera), depth_m_(depth_m), corner_sigma_px_(corner_sigma_px) {
  if (!(depth_m > 0) || !std::isfinite(depth_m))
    throw ConfigError(fmt::format("assumed depth is {} m; must be positive", depth_m));
  if (!(corner_sigma_px > 0) || !std::isfinite(corner_sigma_px))
    throw ConfigError(fmt::format("corner sigma is {} px; must be positive", corner_sigma_px));
}

TargetState AssumedDepthEstimator::estimate(const Track& track) {
  TargetState state;
  state.time_s = track.time_s;
  state.sequence = track.sequence;
  state.quality = track.quality;
  if (track.state == TrackState::LOST) return state;
  const Eigen::Vector2d normalised = camera_.normalise(centre(track.corners));
  if (!normalised.allFinite()) return state;
  state.state = track.state;
  state.T_camera_target.translation() = depth_m_ * normalised.homogeneous();
  // The centre is the mean of four corners: a quarter of their variance, through the inverse of pixel(normalised).
  const Eigen::Matrix2d J =
      (Eigen::Vector2d(camera_.fx, camera_.fy).asDiagonal() * camera_.distort_jacobian(normalised)).inverse() *
      depth_m_;
  state.position_covariance.topLeftCorner<2, 2>() = J * J.transpose() * (corner_sigma_px_ * corner_sigma_px_ / 4);
  return state;
}

}  // namespace heartservo::tracking
