#pragma once
#include <string>

#include "tracking/settings/fields.hpp"

namespace heartservo::tracking {

/// Of the tracker `composite` (composite_aligner.hpp).
struct CompositeOptions {
  std::string weighting = "fixed";  ///< gamma of eq. (12): fixed, eq13, eq14
  double texture_weight = 0.05;     ///< gamma where it is fixed
  int grey_levels = 16;             ///< of the texture matrices
  int places = 4;                   ///< compared by texture, each with its neighbours
  double search_px = 24;            ///< how far from the predicted place, when the motion was not foreseen
  double rotation_deg = 6;          ///< candidates are turned by so much, either way
  double scale = 0.06;              ///< and larger or smaller by this share

  void fields(FieldVisitor& v) {
    v.choice({"weighting", "",
              "how much texture counts beside the squared differences d: a fixed weight, d, or "
              "exp(-d / (1 - d))"},
             weighting, {"fixed", "eq13", "eq14"});
    v.field({"texture_weight", "", "the weight of texture where it is fixed", 0, 1}, texture_weight);
    v.field({"grey_levels", "", "grey levels of the texture matrices", 4, 64}, grey_levels);
    v.field({"places", "", "the places most alike that are compared by texture, with their neighbours", 1, 16}, places);
    v.field({"search_px", "px", "how far around the predicted place candidates lie at most", 2, 100}, search_px);
    v.field({"rotation_deg", "deg", "candidates are turned by this, either way", 0, 30}, rotation_deg);
    v.field({"scale", "", "candidates are larger or smaller by this share", 0, 0.3}, scale);
  }
};

}  // namespace heartservo::tracking
