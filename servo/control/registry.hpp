#pragma once
#include "servo/control/control_law.hpp"
#include "servo/control/control_options.hpp"
#include "tracking/settings/registry.hpp"

namespace heartservo::servo {

/// What a control law is made from.
struct ControlSetup {
  ControlOptions options = {};
  ToolRobotData robot = {};
  double period_s = 0.008;
  double max_speed = 0.3;        ///< m/s, allowed by the guard
  double max_acceleration = 15;  ///< m/s^2, allowed by the guard
};

/// Control laws by name.
const Registry<ControlLaw, const ControlSetup&>& control_laws();

std::unique_ptr<ControlLaw> make_ibvs(const ControlSetup& setup);
std::unique_ptr<ControlLaw> make_ibvs_feedforward(const ControlSetup& setup);
std::unique_ptr<ControlLaw> make_gpc(const ControlSetup& setup);
std::unique_ptr<ControlLaw> make_mpc(const ControlSetup& setup);

}  // namespace heartservo::servo
