#pragma once
// Where a robot's base truly is in the camera frame, and where its maker states it to be.
#include <Eigen/Geometry>
#include <random>

#include "sim/robot/robot_options.hpp"

namespace heartservo::sim {

struct BaseCalibration {
  Eigen::Isometry3d T_camera_base, stated;

  /// The stated calibration turns about the tip's start, so that its error there is calibration_error_m and no more.
  BaseCalibration(const RobotOptions& options, const Eigen::Vector3d& tip_camera, std::mt19937_64& random);
};

/// Uniform on the sphere.
Eigen::Vector3d random_direction(std::mt19937_64& random);

}  // namespace heartservo::sim
