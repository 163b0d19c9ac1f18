#pragma once
#include <Eigen/Core>

#include "servo/prediction/motion_predictor.hpp"

namespace heartservo::servo {

/// All that a control law sees. Positions in the camera frame, m.
struct ControlState {
  double time_s = 0;         ///< of the frame
  double acts_at_s = 0;      ///< when the command will act
  double period_s = 0;       ///< for how long it will hold
  Eigen::Vector3d tip_now;   ///< tool tip at the frame's time
  Eigen::Vector3d tip_then;  ///< where commands already given will have brought the tip when this one acts
  Eigen::Vector3d goal_now;  ///< target + offset at the frame's time
  Prediction goal_then;      ///< predicted target + offset when the command acts
};

/// State -> velocity of the tool tip in the camera frame, m/s. Same state, same answer.
class ControlLaw {
 public:
  virtual ~ControlLaw() = default;
  virtual Eigen::Vector3d velocity(const ControlState& state) = 0;
};

}  // namespace heartservo::servo
