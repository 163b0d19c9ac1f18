#include "servo/ecg/beat_score.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::servo {

BeatScore score_beats(const std::vector<double>& detected, const std::vector<double>& labels, double window_s) {
  BeatScore score{labels.size(), detected.size(), 0, 0, 0, 0};
  std::vector<double> errors;
  std::size_t d = 0;
  for (std::size_t l = 0; l < labels.size(); ++l) {
    while (d < detected.size() && detected[d] < labels[l] - window_s) ++d;
    if (d == detected.size()) break;
    // the nearest within the window that the next label does not have a better claim to
    std::size_t best = d;
    for (std::size_t k = d; k < detected.size() && detected[k] <= labels[l] + window_s; ++k)
      if (std::abs(detected[k] - labels[l]) < std::abs(detected[best] - labels[l])) best = k;
    const double error = detected[best] - labels[l];
    if (std::abs(error) > window_s) continue;
    if (l + 1 < labels.size() && best == d && std::abs(detected[best] - labels[l + 1]) < std::abs(error)) continue;
    errors.push_back(error);
    d = best + 1;
  }
  score.matched = errors.size();
  for (const double e : errors) {
    score.mean_error_s += e / static_cast<double>(errors.size());
    score.largest_error_s = std::max(score.largest_error_s, std::abs(e));
  }
  for (const double e : errors)
    score.sigma_error_s += std::pow(e - score.mean_error_s, 2) / static_cast<double>(errors.size());
  score.sigma_error_s = std::sqrt(score.sigma_error_s);
  return score;
}

}  // namespace heartservo::servo
