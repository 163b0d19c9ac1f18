#pragma once
// Where the tool tip is, in the camera frame: encoders are quick and fine but their calibration is wrong; the marker
// seen in the picture is right but noisy. So the tip is the encoders' through a calibration that is learnt from the
// marker: a Kalman filter of the stated calibration's error, an offset o and a small rotation theta about the place
// where the run began,
//
//   tip by marker = tip by encoders + o + theta x (tip by encoders - start) + noise,
//
// both wandering slowly. The rotation is only seen when the tool moves; until then the prior holds it.
#include <Eigen/Core>

#include "servo/robot/tool_robot.hpp"
#include "tracking/landmark/target_estimator.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::servo {

struct TipOptions {
  bool use_marker = true;
  double offset_drift = 1e-5;     ///< m/sqrt(s)
  double rotation_drift = 2e-4;   ///< rad/sqrt(s)
  double rotation_prior = 0.02;   ///< rad
  double smallest_sigma_m = 5e-5; ///< m

  void fields(FieldVisitor& v) {
    v.field({"use_marker", "", "correct the encoders' calibration by the marker seen in the picture"}, use_marker);
    v.field({"offset_drift", "m/sqrt(s)", "how fast the offset of encoders and picture may wander", 0, 0.1},
            offset_drift);
    v.field({"rotation_drift", "rad/sqrt(s)", "how fast their rotation may wander", 0, 1}, rotation_drift);
    v.field({"rotation_prior", "rad", "how far the stated rotation may be off, per axis; 0: it is not learnt", 0, 0.5},
            rotation_prior);
    v.field({"smallest_sigma_m", "m", "the marker's place is never believed better than this", 1e-7, 0.01},
            smallest_sigma_m);
  }
};

class TipEstimator {
 public:
  /// `marker_to_tip_camera`: at the start, in the camera frame, m; it turns with the tool.
  TipEstimator(const TipOptions& options, const ToolRobotData& robot, const Eigen::Vector3d& marker_to_tip_camera);

  /// The tip at the frame's time (m, camera frame). `marker` is the marker's state in the same frame.
  Eigen::Vector3d estimate(const ToolState& encoders, const tracking::TargetState& marker);

  /// Base frame to camera frame, the learnt rotation in it.
  Eigen::Matrix3d R_camera_base() const;

  /// Learnt so far at the last tip: picture minus encoders (m, camera frame).
  const Eigen::Vector3d& offset() const { return offset_; }

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  void learn(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance, const Eigen::Vector3d& arm, double dt);

  TipOptions options_;
  ToolRobotData robot_;
  Eigen::Vector3d marker_to_tip_;
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero(), start_ = Eigen::Vector3d::Zero();
  Vector6 x_ = Vector6::Zero();  // offset (m), rotation (rad)
  Matrix6 P_ = Matrix6::Zero();
  double last_time_s_ = 0;
  bool started_ = false;
};

}  // namespace heartservo::servo
