#include "servo/control/registry.hpp"

namespace heartservo::servo {

const Registry<ControlLaw, const ControlSetup&>& control_laws() {
  static const Registry<ControlLaw, const ControlSetup&> registry(
      "controller", {{"ibvs", "proportional image-based servo (Nakamura 2001), no feed-forward", make_ibvs},
                     {"ibvs_feedforward", "ibvs on the foreseen features, plus feed-forward by the robot's inverse",
                      make_ibvs_feedforward},
                     {"gpc", "generalised predictive control, the motion foreseen from its last period (Ginhoux 2005)",
                      make_gpc},
                     {"mpc", "receding horizon over the prediction, with the robot's dynamics and limits "
                             "(Cavusoglu, Bebek)",
                      make_mpc}});
  return registry;
}

}  // namespace heartservo::servo
