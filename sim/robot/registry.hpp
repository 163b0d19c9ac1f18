#pragma once
#include <cstdint>

#include "sim/robot/robot_options.hpp"
#include "sim/robot/simulated_robot.hpp"
#include "tracking/settings/registry.hpp"

namespace heartservo::sim {

/// What a simulated robot is made from.
struct RobotSetup {
  RobotOptions options = {};
  Eigen::Vector3d tip_camera{0, 0, 0.055};  ///< where the tip truly is at the start, camera frame, m
  Eigen::Vector3d tool_axis{0, 0, -1};      ///< from the tip along the shaft, camera frame
  std::uint64_t seed = 1;
};

/// Simulated robots by name.
const Registry<SimulatedRobot, const RobotSetup&>& robots();

std::unique_ptr<SimulatedRobot> make_trocar_robot(const RobotSetup& setup);
std::unique_ptr<SimulatedRobot> make_visp_simulation(const RobotSetup& setup);

/// The robot that the options name.
inline std::unique_ptr<SimulatedRobot> make_robot(const RobotSetup& setup) {
  return robots().make(setup.options.type, setup);
}

}  // namespace heartservo::sim
