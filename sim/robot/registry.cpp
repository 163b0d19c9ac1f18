#include "sim/robot/registry.hpp"

#include "sim/robot/cartesian_robot.hpp"

namespace heartservo::sim {

const Registry<SimulatedRobot, const RobotSetup&>& robots() {
  const auto cartesian = [](const RobotSetup& setup) {
    return std::make_unique<CartesianRobot>(setup.options, setup.tip_camera, setup.seed);
  };
  static const Registry<SimulatedRobot, const RobotSetup&> registry(
      "robot", {{"cartesian", "second order, limits, encoder noise", cartesian},
                {"ideal", "follows its reference exactly", cartesian},
                {"trocar", "pan, tilt, insertion and roll through a fixed port, joint limits", make_trocar_robot},
                {"visp", "vpSimulatorCamera through the adapter for any vpRobot", make_visp_simulation}});
  return registry;
}

}  // namespace heartservo::sim
