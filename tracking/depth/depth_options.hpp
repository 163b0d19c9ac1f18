#pragma once
#include <string>
#include <vector>

#include "tracking/settings/fields.hpp"

namespace heartservo::tracking {

/// What is assumed of tissue where a region's depth is followed by its picture alone (docs/depth.md).
struct DepthOptions {
  double wander_sigma_m = 1.2e-4;  ///< of a point's way along the surface by stretching, per axis
  double bulge_sigma_m = 2.5e-4;   ///< of its way across the surface
  double wander_length_m = 8e-3;   ///< points this far apart move nearly together: scale of the correlation
  double tilt_sigma_rad = 0.04;    ///< of the region's tilt since the first frame, about each axis
  double curvature_sigma = 20;     ///< 1/m, of the surface in the first frame
  double memory_s = 0.2;           ///< errors of frames this far apart are independent, for the shape

  void fields(FieldVisitor& v) {
    v.field({"wander_sigma_m", "m", "how far tissue points move along the surface by stretching, standard deviation",
             1e-6, 0.01},
            wander_sigma_m);
    v.field({"bulge_sigma_m", "m", "how far they move across it, standard deviation", 0, 0.01}, bulge_sigma_m);
    v.field({"wander_length_m", "m", "distance over which neighbouring points move together", 1e-4, 0.1},
            wander_length_m);
    v.field({"tilt_sigma_rad", "rad", "standard deviation of the region's tilt since the first frame", 1e-3, 1},
            tilt_sigma_rad);
    v.field({"curvature_sigma", "1/m", "standard deviation of the surface's curvature", 0.1, 1000}, curvature_sigma);
    v.field({"memory_s", "s", "errors of frames this far apart are independent, for the surface's shape", 1e-3, 100},
            memory_s);
  }

  /// Every problem at once; empty when usable.
  std::vector<std::string> validate() const;
};

}  // namespace heartservo::tracking
