#pragma once
#include <string>
#include <vector>

#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

/// The paper's experiment on depth (section 4.1), when tilts are given.
struct DepthRailOptions {
  std::vector<double> tilts_rad;
  double axis_rad = 0.5;
  double laser_m = 0.0005;

  void fields(FieldVisitor& v) {
    v.field({"tilts_rad", "rad", "tilts of the landmark, one run along motion.rail each; empty: no such experiment",
             -1.4, 1.4},
            tilts_rad, 0);
    v.field({"axis_rad", "rad", "direction in the picture of the axis it is tilted about, clockwise from x", -3.2, 3.2},
            axis_rad);
    v.field({"laser_m", "m", "precision of the laser: its readings are off by up to this much, evenly", 0, 0.01},
            laser_m);
  }
};

}  // namespace heartservo::sim
