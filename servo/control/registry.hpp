#pragma once
#include "servo/control/control_law.hpp"
#include "tracking/settings/fields.hpp"
#include "tracking/settings/registry.hpp"

namespace heartservo::servo {

struct ControlOptions {
  double gain = 9;                ///< 1/s, ibvs
  double gain_feedforward = 100;  ///< 1/s, ibvs_feedforward

  void fields(FieldVisitor& v) {
    v.field({"gain", "1/s", "ibvs: proportional gain; above about 1 / (2 x total delay) the loop rings", 0.1, 500},
            gain);
    v.field({"gain_feedforward", "1/s", "ibvs_feedforward: gain on the error that is left after the feed-forward", 0.1,
             500},
            gain_feedforward);
  }
};

/// Control laws by name.
const Registry<ControlLaw, const ControlOptions&>& control_laws();

std::unique_ptr<ControlLaw> make_ibvs(const ControlOptions& options);
std::unique_ptr<ControlLaw> make_ibvs_feedforward(const ControlOptions& options);

}  // namespace heartservo::servo
