#include "sim/sequence/sequence_options.hpp"

#include <fmt/format.h>

namespace heartservo::sim {

SequenceOptions SequenceOptions::named(const std::string& sequence) {
  const SequenceKind& kind = sequence_kind(sequence);
  SequenceOptions options;
  options.sequence = kind.name;
  options.frames = kind.frames;
  options.frame_rate_hz = kind.frame_rate_hz;
  options.noise_grey = kind.noise_grey;
  options.speculars = kind.speculars;
  options.gain = kind.gain;
  options.bias_grey = kind.bias_grey;
  return options;
}

void SequenceOptions::fields(FieldVisitor& v) {
  std::vector<std::string> names;
  for (const auto& kind : sequence_kinds()) names.push_back(kind.name);
  v.choice({"sequence", "", "how the region moves"}, sequence, names);
  v.field({"texture", "", "heart, retina, detail or a picture file"}, texture);
  v.field({"side_px", "px", "side of the region", 12, 200}, side_px);
  v.field({"place", "", "where the region lies in the picture", 0, 2}, place);
  v.field({"seed", "", "of texture, noise, blobs and background", 0, 2e9}, seed);
  v.field({"frames", "", "frames of the sequence", 2, 1e6}, frames);
  v.field({"frame_rate_hz", "Hz", "frames per second", 1, 1e4}, frame_rate_hz);
  v.field({"step", "", "how many times faster than the sequence is defined", 0.01, 100}, step);
  v.field({"noise_grey", "grey", "standard deviation of the noise", 0, 50}, noise_grey);
  v.field({"speculars", "", "moving saturated blobs", 0, 200}, speculars);
  v.field({"gain", "", "amplitude of the gain's swing, period 45 frames", 0, 0.9}, gain);
  v.field({"bias_grey", "grey", "amplitude of the bias's swing, period 30 frames", 0, 100}, bias_grey);
  v.field({"background", "", "frames under the patch of table5 and circle; empty: the simulated heart"}, background);
}

std::vector<std::string> SequenceOptions::validate() const {
  std::vector<std::string> problems;
  const auto require = [&](bool good, const std::string& problem) {
    if (!good) problems.push_back(problem);
  };
  require(side_px >= 12 && side_px <= 200, fmt::format("the region's side is {} px, but must be 12 to 200", side_px));
  require(place >= 0 && place <= 2, fmt::format("place is {}, but must be 0, 1 or 2", place));
  require(frames >= 2, fmt::format("frames is {}, but must be 2 at least", frames));
  require(frame_rate_hz >= 1, "the frame rate is below 1 Hz");
  require(step > 0, "step must be above 0");
  require(noise_grey >= 0 && noise_grey <= 50, fmt::format("noise is {} grey levels, but must be 0 to 50", noise_grey));
  require(speculars >= 0 && speculars <= 200, fmt::format("speculars is {}, but must be 0 to 200", speculars));
  require(gain >= 0 && gain <= 0.9, fmt::format("gain is {}, but must be 0 to 0.9", gain));
  require(bias_grey >= 0 && bias_grey <= 100, fmt::format("bias is {} grey levels, but must be 0 to 100", bias_grey));
  require(background.empty() || sequence_kind(sequence).patch,
          fmt::format("a background is for table5 and circle; in '{}' the whole picture moves", sequence));
  return problems;
}

}  // namespace heartservo::sim
