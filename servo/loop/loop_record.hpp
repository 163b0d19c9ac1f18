#pragma once
#include <Eigen/Core>

#include "servo/prediction/motion_predictor.hpp"
#include "servo/robot/tool_robot.hpp"
#include "servo/safety/command_guard.hpp"
#include "servo/safety/loop_mode.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/landmark/target_estimator.hpp"
#include "tracking/planar/track.hpp"

namespace heartservo::servo {

/// Everything the loop saw and did in one frame. Positions in m, camera frame.
struct LoopRecord {
  tracking::Frame frame;
  tracking::Track track, marker_track;
  tracking::TargetState target, marker;
  ToolState encoders;
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();              ///< as estimated
  Eigen::Vector3d carried = Eigen::Vector3d::Constant(NAN);   ///< target + offset; NaN while the target is lost
  Eigen::Vector3d goal_now = Eigen::Vector3d::Constant(NAN);  ///< the same with the surgeon's path; NaN likewise
  double depth_m = 0;          ///< what the force loop adds along the tissue's normal
  double force_wanted_n = 0;   ///< 0 unless the tip is to press now
  Prediction goal_then;                                       ///< when the command acts, robot lag included
  double r_peak_s = NAN;  ///< of the ECG, where one has become known with this frame; before it
  LoopMode mode = LoopMode::HOLD;
  bool stale = false;        ///< the frame was late or repeated, and not used
  bool implausible = false;  ///< the target jumped further than it can, and was not believed
  GuardReport guard;
  ToolCommand command;
  double age_s = NAN;               ///< of the frame when the loop took it; NaN where no clock says
  double glass_to_command_s = NAN;  ///< from mid-exposure until the command was given; likewise
  double track_ms = 0;  ///< trackers alone
  double chain_ms = 0;  ///< from the frame in memory to the command
};

}  // namespace heartservo::servo
