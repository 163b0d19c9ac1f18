#include "tracking/depth/stereo_depth_estimator.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "tracking/frames/frame.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

StereoDepthEstimator::StereoDepthEstimator(const StereoCamera& camera, const StereoOptions& options,
                                           double corner_sigma_px)
    : matcher_(camera, options), options_(options), corner_sigma_px_(corner_sigma_px) {
  if (!(corner_sigma_px > 0) || !std::isfinite(corner_sigma_px))
    throw ConfigError(fmt::format("corner sigma is {} px; must be positive", corner_sigma_px));
}

void StereoDepthEstimator::look_at(const Frame& frame) {
  left_ = frame.grey;
  right_ = frame.right;
}

TargetState StereoDepthEstimator::estimate(const Track& track) {
  TargetState state;
  state.time_s = track.time_s;
  state.sequence = track.sequence;
  state.quality = track.quality;
  const Camera& camera = matcher_.camera().left;
  const bool fits = left_.cols == camera.width && left_.rows == camera.height && left_.size() == right_.size();
  if (track.state == TrackState::LOST || !is_convex(track.corners) || !fits) return state;
  Quad plane;
  double side_px = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    plane[i] = camera.normalise(track.corners[i]);
    if (!plane[i].allFinite()) return state;
    side_px = std::max(side_px, (track.corners[i] - track.corners[(i + 1) % 4]).norm());
  }
  const Eigen::Matrix3d G = homography_between(rectangle(-1, -1, 2, 2), plane);
  match_ = matcher_.match(left_, right_, G, side_px, match_);
  if (match_.failure != StereoFailure::NONE) return state;

  const Eigen::Vector2d centre = G.col(2).hnormalized();
  const Eigen::Vector3d ray = centre.homogeneous();
  state.T_camera_target.translation() = match_.depth_m * ray;
  // The corners on the plane that touches the tissue at the centre.
  std::array<Eigen::Vector3d, 4> corner;
  for (std::size_t i = 0; i < 4; ++i)
    corner[i] = plane[i].homogeneous() / (1 / match_.depth_m + match_.gradient.dot(plane[i] - centre));
  const Eigen::Vector3d along_x = (corner[1] + corner[2] - corner[0] - corner[3]).normalized();
  const Eigen::Vector3d along_y = corner[2] + corner[3] - corner[0] - corner[1];
  const Eigen::Vector3d z = along_x.cross(along_y).normalized();
  state.T_camera_target.linear() << along_x, z.cross(along_x), z;
  if (!state.T_camera_target.matrix().allFinite()) return state;

  const Eigen::Matrix2d J =
      (Eigen::Vector2d(camera.fx, camera.fy).asDiagonal() * camera.distort_jacobian(centre)).inverse() * match_.depth_m;
  state.position_covariance = match_.sigma_m * match_.sigma_m * ray * ray.transpose();
  state.position_covariance.topLeftCorner<2, 2>() += J * J.transpose() * (corner_sigma_px_ * corner_sigma_px_ / 4);
  state.state = match_.correlation >= options_.ok_correlation ? track.state : TrackState::UNCERTAIN;
  return state;
}

}  // namespace heartservo::tracking
