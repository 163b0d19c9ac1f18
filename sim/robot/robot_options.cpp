#include "sim/robot/robot_options.hpp"

#include <cmath>

#include "sim/robot/base_calibration.hpp"
#include "sim/robot/registry.hpp"

namespace heartservo::sim {

namespace {

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix();
}

}  // namespace

Eigen::Vector3d random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, 1);
  const double x = normal(random), y = normal(random), z = normal(random);
  return Eigen::Vector3d(x, y, z).normalized();
}

BaseCalibration::BaseCalibration(const RobotOptions& options, const Eigen::Vector3d& tip_camera,
                                 std::mt19937_64& random) {
  T_camera_base.linear() = rotation_of(options.base_rotation_rad);
  T_camera_base.translation() = options.base_position_m;
  T_camera_base.makeAffine();
  stated = T_camera_base;
  const Eigen::Matrix3d wrong = rotation_of(options.calibration_error_rad * random_direction(random));
  const Eigen::Vector3d off = options.calibration_error_m * random_direction(random);
  stated.linear() = wrong * T_camera_base.linear();
  stated.translation() = tip_camera + off + wrong * (T_camera_base.translation() - tip_camera);
}

void RobotOptions::fields(FieldVisitor& v) {
  v.choice({"type", "",
            "cartesian: second order, limits, encoder noise; ideal: follows its reference exactly; trocar: four joints "
            "through a fixed port; visp: ViSP's vpSimulatorCamera through the adapter for any vpRobot"},
           type, robots().names());
  v.field({"bandwidth_hz", "Hz", "natural frequency of the robot's own servo", 1, 100}, bandwidth_hz);
  v.field({"damping", "", "damping ratio of the robot's own servo", 0.1, 3}, damping);
  v.field({"dynamics_error", "", "relative error of the bandwidth that the robot states", -0.9, 2}, dynamics_error);
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
  v.field({"port_distance_m", "m", "trocar: from the tip at the start to the port, along the shaft", 0.03, 0.5},
          port_distance_m);
  v.field({"port_error_m", "m", "trocar: how far off the robot's centre of rotation is from the port in the body wall",
           0, 0.01},
          port_error_m);
  v.field({"max_pivot_rad", "rad", "trocar: limit of pan and tilt, from the start", 0.01, 1.4}, max_pivot_rad);
  v.field({"max_insertion_m", "m", "trocar: limit of the insertion, from the start", 0.001, 0.3}, max_insertion_m);
}

}  // namespace heartservo::sim
