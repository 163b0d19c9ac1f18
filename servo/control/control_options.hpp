#pragma once
#include "tracking/settings/fields.hpp"

namespace heartservo::servo {

struct ControlOptions {
  double gain = 9;                ///< 1/s, ibvs
  double gain_feedforward = 100;  ///< 1/s, ibvs_feedforward
  double filter_hz = 0;           ///< Hz; 0: none
  int horizon = 8;                ///< periods; gpc, mpc
  int moves = 4;                  ///< gpc
  double smoothing = 0.5;         ///< gpc, mpc

  void fields(FieldVisitor& v) {
    v.field({"gain", "1/s", "ibvs: proportional gain; above about 1 / (2 x total delay) the loop rings", 0.1, 500},
            gain);
    v.field({"gain_feedforward", "1/s", "ibvs_feedforward: gain on the error that is left after the feed-forward", 0.1,
             500},
            gain_feedforward);
    v.field({"filter_hz", "Hz", "low-pass on every command, which delays it by 1 / (2 pi filter_hz); 0: none", 0, 1000},
            filter_hz);
    v.field({"horizon", "", "gpc, mpc: periods ahead in which tip and goal are compared", 2, 16}, horizon);
    v.field({"moves", "", "gpc: changes of the velocity within the horizon", 1, 16}, moves);
    v.field({"smoothing", "", "gpc, mpc: weight of a change of the way per period against the same distance from the "
             "goal, squared",
             0, 1e6},
            smoothing);
  }
};

}  // namespace heartservo::servo
