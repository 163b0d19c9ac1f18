#pragma once
// Where the tool tip is, in the camera frame: encoders are quick and fine but their calibration is wrong; the marker
// seen in the picture is right but noisy. So the tip is the encoders' plus a slowly learnt offset to the picture's.
#include <Eigen/Core>

#include "servo/robot/tool_robot.hpp"
#include "tracking/landmark/target_estimator.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::servo {

struct TipOptions {
  bool use_marker = true;
  double offset_time_s = 0.4;  ///< s

  void fields(FieldVisitor& v) {
    v.field({"use_marker", "", "correct the encoders' calibration by the marker seen in the picture"}, use_marker);
    v.field({"offset_time_s", "s", "time constant with which the offset of encoders and picture is learnt", 1e-3, 100},
            offset_time_s);
  }
};

class TipEstimator {
 public:
  TipEstimator(const TipOptions& options, const ToolRobotData& robot, const Eigen::Vector3d& marker_to_tip_camera)
      : options_(options), robot_(robot), marker_to_tip_(marker_to_tip_camera) {}

  /// The tip at the frame's time (m, camera frame). `marker` is the marker's state in the same frame.
  Eigen::Vector3d estimate(const ToolState& encoders, const tracking::TargetState& marker);

  /// Learnt so far: picture minus encoders (m, camera frame).
  const Eigen::Vector3d& offset() const { return offset_; }

 private:
  TipOptions options_;
  ToolRobotData robot_;
  Eigen::Vector3d marker_to_tip_;
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  double last_time_s_ = 0;
  long seen_ = 0;
};

}  // namespace heartservo::servo
