#pragma once
#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

/// A stiff square plate with a painted pattern, glued to the tissue (section 2.2).
struct LandmarkOptions {
  double x_m = 0;
  double y_m = 0;
  double side_m = 0.005;
  double angle_rad = 0;

  void fields(FieldVisitor& v) {
    v.field({"x_m", "m", "centre on the tissue, to the right of the anchor", -0.03, 0.03}, x_m);
    v.field({"y_m", "m", "centre on the tissue, below the anchor", -0.03, 0.03}, y_m);
    v.field({"side_m", "m", "side of the square", 0.001, 0.02}, side_m);
    v.field({"angle_rad", "rad", "turned in its plane, clockwise in the picture", -3.2, 3.2}, angle_rad);
  }
};

}  // namespace heartservo::sim
