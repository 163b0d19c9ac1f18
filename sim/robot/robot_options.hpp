#pragma once
#include <Eigen/Core>
#include <string>

#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

struct RobotOptions {
  std::string type = "cartesian";
  double bandwidth_hz = 25;
  double damping = 0.7;
  double dynamics_error = 0;
  double max_speed = 0.4;
  double max_acceleration = 20;
  double encoder_noise_m = 2e-6;
  double calibration_error_rad = 0.0175;
  double calibration_error_m = 0.001;
  Eigen::Vector3d base_rotation_rad{0.3, -0.2, 0.1};
  Eigen::Vector3d base_position_m{0.1, 0.1, 0.1};
  Eigen::Vector3d start_error_m{0.001, -0.001, -0.002};
  double port_distance_m = 0.12;
  double port_error_m = 5e-5;
  double max_pivot_rad = 0.5;
  double max_insertion_m = 0.06;

  void fields(FieldVisitor& v);
};

}  // namespace heartservo::sim
