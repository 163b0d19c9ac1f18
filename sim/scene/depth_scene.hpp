#pragma once
// How a scene's region gets its depth, where it is no landmark.
#include <string>

#include "tracking/depth/depth_options.hpp"
#include "tracking/depth/stereo_match.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

/// For engines.estimator: region_depth.
struct ScaleOptions {
  std::string source = "distance";
  double sigma_m = 2e-4;
  int landmark = 0;
  tracking::DepthOptions assumed;

  void fields(FieldVisitor& v) {
    v.choice({"source", "",
              "how the region's distance becomes known, once: distance (told, or a tool that touches it; simulated: the "
              "true one with an error of sigma_m, recorded: recording.depth_m), landmark (seen in the first frame), "
              "stereo (first stereo frame)"},
             source, {"distance", "landmark", "stereo"});
    v.field({"sigma_m", "m", "standard deviation of that distance, for source: distance", 1e-6, 0.1}, sigma_m);
    v.field({"landmark", "", "index of the landmark, for source: landmark", 0, 100}, landmark);
    assumed.fields(v);
  }
};

/// A second view, for engines.estimator: stereo_depth and depth.source: stereo.
struct StereoViewOptions {
  double baseline_m = 0;
  tracking::StereoOptions matching;

  void fields(FieldVisitor& v) {
    v.field({"baseline_m", "m",
             "the simulated endoscope's second camera, like the first, this far to its right; 0: none. A recorded one: "
             "recording.right",
             0, 0.1},
            baseline_m);
    matching.fields(v);
  }
};

}  // namespace heartservo::sim
