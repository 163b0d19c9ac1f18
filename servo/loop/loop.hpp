#pragma once
// One pass of the house per frame: Frame -> Track -> TargetState -> Prediction -> law -> feed-forward -> filter ->
// limits -> finite check -> ToolRobot. The only place that knows the order, the clock and the latency. Truth is no part
// of any type in here; a score (score.hpp) watches from outside.
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <string>

#include "servo/control/control_law.hpp"
#include "servo/control/low_pass.hpp"
#include "servo/ecg/ecg_monitor.hpp"
#include "servo/loop/loop_options.hpp"
#include "servo/loop/loop_record.hpp"
#include "servo/prediction/motion_predictor.hpp"
#include "servo/robot/robot_model.hpp"
#include "servo/robot/tip_estimator.hpp"
#include "servo/robot/tool_robot.hpp"
#include "servo/safety/command_guard.hpp"
#include "servo/safety/retreat.hpp"
#include "servo/safety/supervisor.hpp"
#include "servo/safety/watchdog.hpp"
#include "tracking/frames/frame_source.hpp"
#include "tracking/landmark/target_estimator.hpp"
#include "tracking/planar/target_tracker.hpp"

namespace heartservo::servo {

/// The stages, made by name from the registries.
struct LoopStages {
  std::unique_ptr<tracking::TargetTracker> target_tracker, marker_tracker;
  std::unique_ptr<tracking::TargetEstimator> target_estimator, marker_estimator;
  std::unique_ptr<MotionPredictor> predictor;
  std::unique_ptr<EcgMonitor> ecg;  ///< null: none; its beats reach the predictor
  std::unique_ptr<ControlLaw> control_law;
  /// Corners picked by hand in the first frame -> subpixel corners; empty: as picked.
  std::function<tracking::Quad(const tracking::Frame&, const tracking::Quad&)> refine_target, refine_marker;
  /// Now, on the clock of the frames' time stamps (s), for the watchdog of their age; empty where no such clock runs.
  std::function<double()> frame_clock;
};

class Loop {
 public:
  /// `stopwatch` gives seconds from any origin, for the timing columns and the watchdog of computing time.
  Loop(tracking::FrameSource& frames, ToolRobot& robot, LoopStages stages, const LoopOptions& options,
       const Eigen::Vector3d& marker_to_tip_camera, std::function<double()> stopwatch);

  /// The first frame, for someone to pick the regions in; null where there is none.
  const tracking::Frame* first_frame();

  /// Shows the trackers their regions in the first frame. "" or the reason why they refuse.
  std::string start(const tracking::Quad& target_region, const tracking::Quad& marker_region);

  /// Follows this region of the frame of the last step instead, with a new tracker, estimator and predictor; the other
  /// stages stay. The tool holds until the target is known, and then approaches it slowly, as after a loss. "" or the
  /// reason for which the region is refused: then all stays as it was.
  std::string restart(LoopStages fresh, const tracking::Quad& region);

  tracking::TargetTracker& target_tracker() { return *stages_.target_tracker; }

  /// One frame; false at the end of the frames or when the guard stopped the loop (see stop_reason()).
  bool step(LoopRecord& record);

  /// "" while all is well, else why the guard ended the loop.
  const std::string& stop_reason() const { return stop_reason_; }

 private:
  tracking::Quad refined(const std::function<tracking::Quad(const tracking::Frame&, const tracking::Quad&)>& refine,
                         const tracking::Quad& picked) const;
  void perceive(LoopRecord& record);
  void decide(LoopRecord& record);
  Eigen::Vector3d tip_of(const LoopRecord& record);
  Eigen::Vector3d wanted(LoopRecord& record, double acts_at);
  bool may_coast(double time_s) const;
  void turn_to(const Eigen::Matrix3d& R_camera_target);
  Prediction goal_at(double time_s) const;
  Eigen::Vector3d shift_at(double time_s) const;

  tracking::FrameSource& frames_;
  ToolRobot& robot_;
  LoopStages stages_;
  LoopOptions options_;
  ToolRobotData robot_data_;
  RobotLag lag_;
  RobotModel model_;
  TipEstimator tip_estimator_;
  SurgeonPath path_;
  ForceLoop force_;
  LowPass filter_;
  Supervisor supervisor_;
  Retreat retreat_;
  Watchdog watchdog_;
  CommandGuard guard_;
  std::function<double()> stopwatch_;
  tracking::Frame frame_;
  Eigen::Matrix3d R_camera_target_ = Eigen::Matrix3d::Identity();  // smoothed
  Eigen::AlignedBox3d seen_goals_;  // of LoopRecord::carried, camera frame, m
  Eigen::Vector3d encoders_start_ = Eigen::Vector3d::Zero();           // camera frame, m; eye-in-hand
  Eigen::Vector3d view_ = Eigen::Vector3d::Constant(NAN);              // the place held in the picture; eye-in-hand
  Eigen::Vector3d last_velocity_ = Eigen::Vector3d::Zero();  // camera frame
  bool any_frame_ = false, first_ = true, ever_seen_ = false;
  std::string stop_reason_;
};

}  // namespace heartservo::servo
