#pragma once
// A Cartesian robot whose own position servo behaves as a second-order system. Velocity commands are integrated to a
// reference path, limited in speed and acceleration; the tip follows the reference. Encoders are noisy and the
// kinematic calibration that the robot states is wrong by a stated amount. As `ideal` the tip is the reference.
#include <Eigen/Geometry>
#include <cstdint>
#include <random>

#include "sim/robot/base_calibration.hpp"
#include "sim/robot/robot_options.hpp"
#include "sim/robot/simulated_robot.hpp"
#include "sim/robot/tip_drive.hpp"

namespace heartservo::sim {

class CartesianRobot final : public SimulatedRobot {
 public:
  /// The tip starts at `tip_camera` (m, camera frame, true).
  CartesianRobot(const RobotOptions& options, const Eigen::Vector3d& tip_camera, std::uint64_t seed);

  servo::ToolRobotData data() const override;
  servo::ToolState read(double time_s) override;
  void command(const servo::ToolCommand& command) override { drive_.command(command); }
  void advance_to(double time_s) override;
  Eigen::Vector3d true_tip_camera() const override { return calibration_.T_camera_base * position_; }
  Eigen::Vector3d true_velocity_camera() const override { return calibration_.T_camera_base.linear() * velocity_; }

 private:
  void substep(double dt);
  bool is_ideal() const { return options_.type == "ideal"; }

  RobotOptions options_;
  std::mt19937_64 random_;
  BaseCalibration calibration_;
  TipDrive drive_;
  double time_s_ = 0;
  Eigen::Vector3d position_, velocity_, reference_;  // base frame
  std::normal_distribution<double> normal_{0, 1};
};

/// What a robot with these options states about itself. `stated`: its base in the camera frame.
servo::ToolRobotData stated_data(const RobotOptions& options, const Eigen::Isometry3d& stated);

}  // namespace heartservo::sim
