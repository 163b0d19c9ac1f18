#include "sim/robot/cartesian_robot.hpp"

#include <cmath>

namespace heartservo::sim {

namespace {

constexpr double kSubstep_s = 1e-4;  // 150 times shorter than the fastest time constant allowed

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix();
}

Eigen::Vector3d random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, 1);
  const double x = normal(random), y = normal(random), z = normal(random);
  return Eigen::Vector3d(x, y, z).normalized();
}

}  // namespace

void RobotOptions::fields(FieldVisitor& v) {
  v.choice({"type", "", "cartesian: second order, limits, encoder noise; ideal: follows its reference exactly"}, type,
           {"cartesian", "ideal"});
  v.field({"bandwidth_hz", "Hz", "natural frequency of the robot's own servo", 1, 100}, bandwidth_hz);
  v.field({"damping", "", "damping ratio of the robot's own servo", 0.1, 3}, damping);
  v.field({"max_speed", "m/s", "the drives go no faster", 1e-3, 10}, max_speed);
  v.field({"max_acceleration", "m/s^2", "the drives accelerate no faster", 1e-2, 1e4}, max_acceleration);
  v.field({"encoder_noise_m", "m", "standard deviation of the tip position by encoders, per axis", 0, 1e-2},
          encoder_noise_m);
  v.field({"calibration_error_rad", "rad", "angle by which the stated base orientation is wrong (axis from the seed)",
           0, 0.5},
          calibration_error_rad);
  v.field({"calibration_error_m", "m",
           "how far off the stated position of the tip is at the start (direction from the seed)", 0, 0.05},
          calibration_error_m);
  v.field({"base_rotation_rad", "rad", "rotation vector of the robot's base in the camera frame", -3.2, 3.2},
          base_rotation_rad);
  v.field({"base_position_m", "m", "position of the robot's base in the camera frame", -2, 2}, base_position_m);
  v.field({"start_error_m", "m", "where the tip is at the start, from the goal (camera frame)", -0.05, 0.05},
          start_error_m);
}

CartesianRobot::CartesianRobot(const RobotOptions& options, const Eigen::Vector3d& tip_camera, std::uint64_t seed)
    : options_(options), random_(seed) {
  T_camera_base_.linear() = rotation_of(options.base_rotation_rad);
  T_camera_base_.translation() = options.base_position_m;
  T_camera_base_.makeAffine();
  // The stated calibration turns about the tip's start, so that its error there is calibration_error_m and no more.
  T_camera_base_stated_ = T_camera_base_;
  const Eigen::Matrix3d wrong = rotation_of(options.calibration_error_rad * random_direction(random_));
  const Eigen::Vector3d off = options.calibration_error_m * random_direction(random_);
  T_camera_base_stated_.linear() = wrong * T_camera_base_.linear();
  T_camera_base_stated_.translation() = tip_camera + off + wrong * (T_camera_base_.translation() - tip_camera);
  position_ = reference_ = T_camera_base_.inverse() * tip_camera;
  velocity_ = reference_velocity_ = commanded_velocity_ = Eigen::Vector3d::Zero();
}

servo::ToolRobotData CartesianRobot::data() const {
  servo::ToolRobotData data;
  data.R_camera_base = T_camera_base_stated_.linear();
  data.t_camera_base = T_camera_base_stated_.translation();
  data.max_speed = options_.max_speed;
  data.max_acceleration = options_.max_acceleration;
  data.lag_s = options_.type == "ideal" ? 0 : 2 * options_.damping / (2 * M_PI * options_.bandwidth_hz);
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

void CartesianRobot::command(const servo::ToolCommand& command) {
  queue_[queued_ % queue_.size()] = command;
  ++queued_;
}

void CartesianRobot::take_commands() {
  while (taken_ < queued_ && queue_[taken_ % queue_.size()].acts_at_s <= time_s_ + 0.5 * kSubstep_s) {
    commanded_velocity_ = queue_[taken_ % queue_.size()].velocity;
    const double speed = commanded_velocity_.norm();
    if (speed > options_.max_speed) commanded_velocity_ *= options_.max_speed / speed;
    ++taken_;
  }
}

void CartesianRobot::substep(double dt) {
  Eigen::Vector3d change = commanded_velocity_ - reference_velocity_;
  const double length = change.norm(), longest = options_.max_acceleration * dt;
  if (options_.type != "ideal" && length > longest) change *= longest / length;
  reference_velocity_ += change;
  reference_ += reference_velocity_ * dt;
  if (options_.type == "ideal") {
    position_ = reference_;
    velocity_ = reference_velocity_;
    return;
  }
  const double w = 2 * M_PI * options_.bandwidth_hz;
  const Eigen::Vector3d acceleration = w * w * (reference_ - position_) - 2 * options_.damping * w * velocity_;
  velocity_ += acceleration * dt;  // semi-implicit Euler: stable, and at this step within 1e-3 of the exact response
  position_ += velocity_ * dt;
}

void CartesianRobot::advance_to(double time_s) {
  while (time_s_ < time_s) {
    take_commands();
    const double dt = std::min(kSubstep_s, time_s - time_s_);
    substep(dt);
    time_s_ = dt < kSubstep_s ? time_s : time_s_ + dt;
  }
  take_commands();
}

}  // namespace heartservo::sim
