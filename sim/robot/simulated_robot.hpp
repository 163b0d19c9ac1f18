#pragma once
#include <Eigen/Core>

#include "servo/robot/tool_robot.hpp"

namespace heartservo::sim {

/// A robot of the virtual operating table: moved on by whoever owns the clock, and known as it truly is to the picture
/// and the score.
class SimulatedRobot : public servo::ToolRobot {
 public:
  /// Moves the world on; never back.
  virtual void advance_to(double time_s) = 0;

  /// Truth: the tip in the camera frame (m).
  virtual Eigen::Vector3d true_tip_camera() const = 0;

  /// Truth: the tip's velocity in the camera frame (m/s).
  virtual Eigen::Vector3d true_velocity_camera() const = 0;

  /// Truth: how far the tool has turned since the start, in the camera frame.
  virtual Eigen::Matrix3d true_turn_camera() const { return Eigen::Matrix3d::Identity(); }

  /// Truth: distance of the shaft from the port it goes through, m; 0 for a robot without one.
  virtual double port_deviation_m() const { return 0; }
};

}  // namespace heartservo::sim
