#pragma once
// What the robot will do with the commands it was given: velocity commands are integrated to a reference, which the
// tip follows as a second-order system, the same along every axis,
//
//   p'' = w^2 (r - p) - 2 zeta w p',   w = 2 pi bandwidth,   |r''| <= max_acceleration, |r'| <= max_speed,
//
// with the numbers that the robot's maker states. Turned around, it says where the robot must be asked to be so that
// its tip is at p(t):  r = p + (2 zeta / w) p' + p'' / w^2  (asked_for()).
#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "servo/robot/tool_robot.hpp"

namespace heartservo::servo {

/// Positions in m relative to the start, or in any frame once rotated and shifted.
struct RobotState {
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();           ///< where the robot has been asked to be
  Eigen::Vector3d reference_velocity = Eigen::Vector3d::Zero();  ///< m/s
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();                 ///< where it is
  Eigen::Vector3d tip_velocity = Eigen::Vector3d::Zero();        ///< m/s
};

/// The two coefficients of the inverse: r = p + lag p' + lag2 p''.
struct RobotLag {
  double lag_s = 0, lag2_s2 = 0;
  explicit RobotLag(const ToolRobotData& data);
  Eigen::Vector3d asked_for(const Eigen::Vector3d& p, const Eigen::Vector3d& velocity,
                            const Eigen::Vector3d& acceleration) const {
    return p + lag_s * velocity + lag2_s2 * acceleration;
  }
};

class RobotModel {
 public:
  explicit RobotModel(const ToolRobotData& data);

  /// Commands must come in the order in which they act.
  void command(const ToolCommand& command);

  /// Moves the model on; never back.
  void advance_to(double time_s);
  const RobotState& state() const { return state_; }

  /// Where the robot will be at `time_s` by the commands given so far.
  RobotState at(double time_s) const;

  /// One step of a state under a commanded velocity (m/s).
  void step(RobotState& state, const Eigen::Vector3d& commanded, double dt) const;

 private:
  Eigen::Vector3d commanded_at(double time_s, std::size_t& taken) const;
  double run(RobotState& state, double from_s, double to_s, std::size_t& taken) const;

  double w_ = 0, damping_ = 1;  // w_ 0: the tip is where the reference is
  double max_speed_, max_acceleration_;
  double time_s_ = 0;
  RobotState state_;
  std::array<ToolCommand, 256> queue_{};  // 2 s at 125 Hz: longer than any latency a loop can live with
  std::size_t given_ = 0, taken_ = 0;
};

}  // namespace heartservo::servo
