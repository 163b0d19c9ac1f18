#pragma once
// Detected beats beside expert labels (as in ANSI/AAMI EC57, with a stated window).
#include <cstddef>
#include <vector>

namespace heartservo::servo {

struct BeatScore {
  std::size_t labels = 0, detected = 0, matched = 0;
  double mean_error_s = 0, sigma_error_s = 0, largest_error_s = 0;  ///< detected - label, of the matched
  double sensitivity_percent() const {
    return labels > 0 ? 100.0 * static_cast<double>(matched) / static_cast<double>(labels) : 0;
  }
  double positive_predictivity_percent() const {
    return detected > 0 ? 100.0 * static_cast<double>(matched) / static_cast<double>(detected) : 0;
  }
};

/// Both increasing, s. A label and a detection match when they are no further apart than `window_s`; each at most once,
/// the nearest first.
BeatScore score_beats(const std::vector<double>& detected, const std::vector<double>& labels, double window_s);

}  // namespace heartservo::servo
