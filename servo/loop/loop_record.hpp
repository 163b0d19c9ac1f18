#pragma once
#include <Eigen/Core>

#include "servo/prediction/motion_predictor.hpp"
#include "servo/robot/tool_robot.hpp"
#include "servo/safety/command_guard.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/landmark/target_estimator.hpp"
#include "tracking/planar/track.hpp"

namespace heartservo::servo {

/// What the command of a frame was based on.
enum class LoopMode {
  FOLLOW,  ///< target seen in this frame
  COAST,   ///< target lost a moment ago: its prediction is followed
  HOLD,    ///< target lost for too long, or not yet known: the tool stands still
};

/// Everything the loop saw and did in one frame. Positions in m, camera frame.
struct LoopRecord {
  tracking::Frame frame;
  tracking::Track track, marker_track;
  tracking::TargetState target, marker;
  ToolState encoders;
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();              ///< as estimated
  Eigen::Vector3d goal_now = Eigen::Vector3d::Constant(NAN);  ///< target + offset; NaN while the target is lost
  Prediction goal_then;                                       ///< when the command acts, robot lag included
  double r_peak_s = NAN;  ///< of the ECG, where one has become known with this frame; before it
  LoopMode mode = LoopMode::HOLD;
  GuardReport guard;
  ToolCommand command;
  double track_ms = 0;  ///< trackers alone
  double chain_ms = 0;  ///< from the frame in memory to the command
};

}  // namespace heartservo::servo
