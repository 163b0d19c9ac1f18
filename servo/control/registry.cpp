#include "servo/control/registry.hpp"

namespace heartservo::servo {

const Registry<ControlLaw, const ControlOptions&>& control_laws() {
  static const Registry<ControlLaw, const ControlOptions&> registry(
      "controller", {{"ibvs", "proportional image-based servo (Nakamura 2001), no feed-forward", make_ibvs},
                     {"ibvs_feedforward", "ibvs on the foreseen features, plus the target's foreseen velocity",
                      make_ibvs_feedforward}});
  return registry;
}

}  // namespace heartservo::servo
