#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "sim/endoscope/tissue_texture.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

/// What the endoscope's light, lens and sensor make of the tissue.
struct PictureOptions {
  std::string light = "xenon";
  Eigen::Vector3d light_position_m{0.004, -0.001, 0};
  double light_distance_m = 0.055;
  double exposure = 1;
  double specular_grey = 420;
  double specular_roughness = 0.12;
  double vignetting = 0.2;
  double gain = 1;
  double bias_grey = 4;
  double noise_grey = 3;
  TextureOptions texture;

  void fields(FieldVisitor& v) {
    v.choice(
        {"light", "", "xenon: from the endoscope's tip, with speculars and vignetting; flat: the texture as it is"},
        light, {"xenon", "flat"});
    v.field({"light_position_m", "m", "where the light leaves the endoscope, camera frame", -0.05, 0.05},
            light_position_m);
    v.field({"light_distance_m", "m", "distance at which tissue has its texture's grey level", 0.01, 0.3},
            light_distance_m);
    v.field({"exposure", "", "factor on all light", 0, 5}, exposure);
    v.field({"specular_grey", "grey", "brightness of a perfect reflex; above 255 it saturates", 0, 2000},
            specular_grey);
    v.field({"specular_roughness", "", "slope by which the wet surface scatters reflexes", 0.02, 0.5},
            specular_roughness);
    v.field({"vignetting", "", "loss of light in the picture's corners", 0, 1}, vignetting);
    v.field({"gain", "", "of the sensor, on everything but noise", 0.05, 10}, gain);
    v.field({"bias_grey", "grey", "added to every pixel", -100, 100}, bias_grey);
    v.field({"noise_grey", "grey", "standard deviation of the sensor's noise", 0, 50}, noise_grey);
    v.group("texture", "the tissue's looks", texture);
  }

  /// Every problem at once, empty when usable.
  std::vector<std::string> validate() const;
};

}  // namespace heartservo::sim
