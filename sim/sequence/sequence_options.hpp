#pragma once
#include <string>
#include <vector>

#include "sim/sequence/planar_motion.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

/// An artificial sequence with everything decided. named() gives what the sequence has unless asked otherwise.
struct SequenceOptions {
  std::string sequence = "b";
  std::string texture = "detail";
  int side_px = 80;
  int place = 0;
  int seed = 1;
  int frames = 151;
  double frame_rate_hz = 125;
  double step = 1;
  double noise_grey = 1;
  int speculars = 0;
  double gain = 0;
  double bias_grey = 0;
  std::string background;

  static SequenceOptions named(const std::string& sequence);

  void fields(FieldVisitor& v);
  /// Every problem at once, empty when the sequence can be made.
  std::vector<std::string> validate() const;
};

}  // namespace heartservo::sim
