#pragma once
#include <Eigen/Core>
#include <array>

#include "servo/prediction/motion_predictor.hpp"
#include "servo/robot/robot_model.hpp"

namespace heartservo::servo {

inline constexpr int kLongestHorizon = 16;  ///< periods

/// All that a control law sees. Positions in the camera frame, m.
struct ControlState {
  double time_s = 0;               ///< of the frame
  double acts_at_s = 0;            ///< when the command will act
  double period_s = 0;             ///< for how long it will hold
  Eigen::Vector3d tip_now;         ///< tool tip at the frame's time
  Eigen::Vector3d goal_now;        ///< target + offset at the frame's time, without what the surgeon's path or an
                                   ///< approach adds; NaN while the target is not seen
  Prediction goal_then;            ///< predicted goal when the command acts, the robot's lag included
  RobotState robot;                ///< where commands already given will have brought the robot when this one acts
  Eigen::Vector3d last_velocity;   ///< of the command before, m/s
  /// Predicted goal at acts_at_s + k period_s in goals[k + 1], k = -1 .. horizon of the law.
  std::array<Prediction, kLongestHorizon + 2> goals;
  /// What the surgeon's path or an approach adds, contained in the positions of `goals`.
  std::array<Eigen::Vector3d, kLongestHorizon + 2> shifts;
  const Eigen::Vector3d& shift(int k) const { return shifts[static_cast<std::size_t>(k + 1)]; }
  const Prediction& goal(int k) const { return goals[static_cast<std::size_t>(k + 1)]; }
};

/// State -> velocity of the tool tip in the camera frame, m/s.
class ControlLaw {
 public:
  virtual ~ControlLaw() = default;

  virtual Eigen::Vector3d velocity(const ControlState& state) = 0;

  /// How many periods ahead of acts_at_s it looks: as many goals are foreseen for it.
  virtual int horizon() const { return 0; }

  /// True: the velocity is a correction, to which the loop adds the feed-forward (feed_forward.hpp).
  virtual bool wants_feed_forward() const { return false; }
};

}  // namespace heartservo::servo
