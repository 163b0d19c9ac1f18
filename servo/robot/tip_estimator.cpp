#include "servo/robot/tip_estimator.hpp"

#include <algorithm>

namespace heartservo::servo {

Eigen::Vector3d TipEstimator::estimate(const ToolState& encoders, const tracking::TargetState& marker) {
  const Eigen::Vector3d by_encoders = robot_.R_camera_base * encoders.tip + robot_.t_camera_base;
  if (options_.use_marker && marker.state == tracking::TrackState::OK) {
    const Eigen::Vector3d error = marker.T_camera_target.translation() + marker_to_tip_ - by_encoders - offset_;
    // An average at first, a low-pass later: the gain never falls below dt / time constant.
    const double dt = seen_ > 0 ? marker.time_s - last_time_s_ : 0;
    const double gain =
        std::clamp(std::max(1.0 / static_cast<double>(seen_ + 1), dt / options_.offset_time_s), 0.0, 1.0);
    offset_ += gain * error;
    last_time_s_ = marker.time_s;
    ++seen_;
  }
  return by_encoders + offset_;
}

}  // namespace heartservo::servo
