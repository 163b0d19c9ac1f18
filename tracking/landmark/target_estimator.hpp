#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <string>

#include "tracking/planar/track.hpp"

namespace heartservo::tracking {

struct Frame;

/// Metric state of the target at one frame.
struct TargetState {
  double time_s = 0;
  std::uint64_t sequence = 0;
  TrackState state = TrackState::LOST;  ///< LOST: nothing below is valid
  double quality = 0;
  Eigen::Isometry3d T_camera_target = Eigen::Isometry3d::Identity();  ///< target frame: centre of the region, m
  /// m^2, camera frame: of the errors that are new in every frame, which a predictor may average away.
  Eigen::Matrix3d position_covariance = Eigen::Matrix3d::Zero();
  /// m^2, camera frame: of the errors that stay or change slowly (scale, stretch of tissue). The whole is the sum.
  Eigen::Matrix3d lasting_covariance = Eigen::Matrix3d::Zero();
};

/// Pixels to metres.
class TargetEstimator {
 public:
  virtual ~TargetEstimator() = default;
  /// The frame that the next track comes from, for those who want more of it than the track. The pixels must stay until
  /// estimate().
  virtual void look_at(const Frame&) {}
  virtual TargetState estimate(const Track& track) = 0;
};

}  // namespace heartservo::tracking
