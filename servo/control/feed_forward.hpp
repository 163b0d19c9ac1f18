#pragma once
// Feed-forward by the inverse of the robot's stated dynamics (robot_model.hpp): the velocity that moves the robot's
// reference along the path it must be asked for so that its tip is where the goal will be. Bebek and Cavusoglu (IEEE
// T-RO 2007) feed the estimated motion forward in the same place; the inverse stands for their model of the robot.
#include "servo/control/control_law.hpp"

namespace heartservo::servo {

/// Where the robot must be asked to be when the command acts (k = 0) and one period later (k = 1); needs goals -1 to 2.
inline Eigen::Vector3d asked_goal(const ControlState& state, const RobotLag& lag, int k) {
  const Eigen::Vector3d acceleration =
      (state.goal(k + 1).velocity - state.goal(k - 1).velocity) / (2 * state.period_s);
  return lag.asked_for(state.goal(k).position, state.goal(k).velocity, acceleration);
}

/// Mean velocity of that path while the command holds.
inline Eigen::Vector3d feed_forward(const ControlState& state, const RobotLag& lag) {
  return (asked_goal(state, lag, 1) - asked_goal(state, lag, 0)) / state.period_s;
}

}  // namespace heartservo::servo
