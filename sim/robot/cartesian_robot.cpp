#include "sim/robot/cartesian_robot.hpp"

#include <cmath>

namespace heartservo::sim {

namespace {

constexpr double kSubstep_s = 1e-4;  // 150 times shorter than the fastest time constant allowed

}  // namespace

servo::ToolRobotData stated_data(const RobotOptions& options, const Eigen::Isometry3d& stated) {
  servo::ToolRobotData data;
  data.R_camera_base = stated.linear();
  data.t_camera_base = stated.translation();
  data.max_speed = options.max_speed;
  data.max_acceleration = options.max_acceleration;
  data.bandwidth_hz = options.bandwidth_hz * (1 + options.dynamics_error);
  data.damping = options.damping;
  data.lag_s = 2 * data.damping / (2 * M_PI * data.bandwidth_hz);
  return data;
}

CartesianRobot::CartesianRobot(const RobotOptions& options, const Eigen::Vector3d& tip_camera, std::uint64_t seed)
    : options_(options),
      random_(seed),
      calibration_(options, tip_camera, random_),
      drive_(options.max_speed, is_ideal() ? INFINITY : options.max_acceleration) {
  position_ = reference_ = calibration_.T_camera_base.inverse() * tip_camera;
  velocity_.setZero();
}

servo::ToolRobotData CartesianRobot::data() const {
  servo::ToolRobotData data = stated_data(options_, calibration_.stated);
  if (is_ideal()) data.max_acceleration = data.bandwidth_hz = data.lag_s = 0;
  return data;
}

servo::ToolState CartesianRobot::read(double time_s) {
  advance_to(time_s);
  servo::ToolState state;
  state.time_s = time_s_;
  state.tip = position_;
  for (int i = 0; i < 3; ++i) state.tip[i] += options_.encoder_noise_m * normal_(random_);
  state.velocity = velocity_;
  return state;
}

void CartesianRobot::substep(double dt) {
  const Eigen::Vector3d& reference_velocity = drive_.step(time_s_, dt);
  reference_ += reference_velocity * dt;
  if (is_ideal()) {
    position_ = reference_;
    velocity_ = reference_velocity;
    return;
  }
  const double w = 2 * M_PI * options_.bandwidth_hz;
  const Eigen::Vector3d acceleration = w * w * (reference_ - position_) - 2 * options_.damping * w * velocity_;
  velocity_ += acceleration * dt;  // semi-implicit Euler: stable, and at this step within 1e-3 of the exact response
  position_ += velocity_ * dt;
}

void CartesianRobot::advance_to(double time_s) {
  while (time_s_ < time_s) {
    const double dt = std::min(kSubstep_s, time_s - time_s_);
    substep(dt);
    time_s_ = dt < kSubstep_s ? time_s : time_s_ + dt;
  }
}

}  // namespace heartservo::sim
