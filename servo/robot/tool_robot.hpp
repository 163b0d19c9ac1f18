#pragma once
#include <Eigen/Core>
#include <limits>

namespace heartservo::servo {

/// What the robot's encoders say. Its kinematic calibration may be wrong: `tip` is where the robot believes its tip is.
struct ToolState {
  double time_s = 0;
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();                   ///< m, robot base frame
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();              ///< m/s, robot base frame
  Eigen::Matrix3d R_start_tool = Eigen::Matrix3d::Identity();      ///< how far the tool has turned since the start,
                                                                   ///< base frame
  double force_n = 0;  ///< on the tip along the tool's axis, N, positive when it presses; 0 without a sensor
};

/// Velocity of the tool tip, held until the next command acts.
struct ToolCommand {
  double acts_at_s = 0;                                ///< time from which it holds
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s, robot base frame
  /// The robot stops by itself at this time, unless another command has come.
  double expires_at_s = std::numeric_limits<double>::infinity();
};

/// What the maker of the robot states about it.
struct ToolRobotData {
  Eigen::Matrix3d R_camera_base = Eigen::Matrix3d::Identity();  ///< nominal orientation of the base
  Eigen::Vector3d t_camera_base = Eigen::Vector3d::Zero();      ///< nominal position of the base, m
  double max_speed = 0;                                         ///< m/s, norm
  double max_acceleration = 0;                                  ///< m/s^2, norm; 0: not stated
  double lag_s = 0;         ///< delay of a slow motion through the robot's own servo: 2 zeta / omega_n
  double bandwidth_hz = 0;  ///< omega_n / 2 pi of the robot's own position servo; 0: not stated, or no lag
  double damping = 0.7;     ///< its zeta
};

/// A robot that carries the tool. A command is given ahead of the time at which it acts.
class ToolRobot {
 public:
  virtual ~ToolRobot() = default;
  virtual ToolRobotData data() const = 0;
  virtual ToolState read(double time_s) = 0;
  virtual void command(const ToolCommand& command) = 0;
};

}  // namespace heartservo::servo
