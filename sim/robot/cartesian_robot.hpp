#pragma once
// A Cartesian robot whose own position servo behaves as a second-order system. Velocity commands are integrated to a
// reference path, limited in speed and acceleration; the tip follows the reference. Encoders are noisy and the
// kinematic calibration that the robot states is wrong by a stated amount.
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "servo/robot/tool_robot.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

struct RobotOptions {
  std::string type = "cartesian";
  double bandwidth_hz = 25;
  double damping = 0.7;
  double max_speed = 0.4;
  double max_acceleration = 20;
  double encoder_noise_m = 2e-6;
  double calibration_error_rad = 0.0175;
  double calibration_error_m = 0.001;
  Eigen::Vector3d base_rotation_rad{0.3, -0.2, 0.1};
  Eigen::Vector3d base_position_m{0.1, 0.1, 0.1};
  Eigen::Vector3d start_error_m{0.001, -0.001, -0.002};

  void fields(FieldVisitor& v);
};

class CartesianRobot final : public servo::ToolRobot {
 public:
  /// The tip starts at `tip_camera` (m, camera frame, true).
  CartesianRobot(const RobotOptions& options, const Eigen::Vector3d& tip_camera, std::uint64_t seed);

  servo::ToolRobotData data() const override;
  servo::ToolState read(double time_s) override;
  void command(const servo::ToolCommand& command) override;

  /// Moves the world on; never back. Called by whoever owns the clock.
  void advance_to(double time_s);

  /// Truth, for the picture and the score: the tip in the camera frame (m).
  Eigen::Vector3d true_tip_camera() const { return T_camera_base_ * position_; }

 private:
  void substep(double dt);
  void take_commands();

  RobotOptions options_;
  Eigen::Isometry3d T_camera_base_, T_camera_base_stated_;
  double time_s_ = 0;
  Eigen::Vector3d position_, velocity_, reference_, reference_velocity_, commanded_velocity_;  // base frame
  std::array<servo::ToolCommand, 256> queue_{};
  std::size_t queued_ = 0, taken_ = 0;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0, 1};
};

}  // namespace heartservo::sim
