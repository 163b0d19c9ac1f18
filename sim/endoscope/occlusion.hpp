#pragma once
// Something that comes before the region for a while: a swab, blood, a finger.
#include <cstdint>
#include <opencv2/core.hpp>

#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

struct OcclusionOptions {
  double start_s = 5, duration_s = 0.5;
  double radius_m = 0.0055;

  void fields(FieldVisitor& v) {
    v.field({"start_s", "s", "when it comes", 0, 1e5}, start_s);
    v.field({"duration_s", "s", "how long it stays", 0, 1e5}, duration_s);
    v.field({"radius_m", "m", "of the disc that covers the target", 1e-4, 0.05}, radius_m);
  }
  bool covers(double t) const { return t >= start_s && t < start_s + duration_s; }
};

/// Draws a woven swab (CV_8UC1, with grey noise of its own) over a disc.
void draw_swab(cv::Mat& grey, cv::Point2d centre_px, double radius_px, double noise_grey, std::uint64_t seed);

}  // namespace heartservo::sim
