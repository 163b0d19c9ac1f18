#include "tracking/planar/candidate_score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace heartservo::tracking {

Weighting weighting_of(const std::string& name) {
  return name == "eq13" ? Weighting::EQ13 : name == "eq14" ? Weighting::EQ14 : Weighting::FIXED;
}

double CandidateScore::gamma(double d) const {
  switch (weighting_) {
    case Weighting::EQ13:
      return d;
    case Weighting::EQ14:
      return d < 1 ? std::exp(-d / (1 - d)) : 0;
    case Weighting::FIXED:
      break;
  }
  return fixed_gamma_;
}

void CandidateScore::choose(std::vector<Roi>& rois) const {
  double best = std::numeric_limits<double>::infinity();  // no candidate that scores worse than this can win
  for (const Roi& roi : rois) {
    const double g = gamma(roi.d);
    best = std::min(best, (1 - g) * roi.d + g);
  }
  for (Roi& roi : rois) roi.compared = (1 - gamma(roi.d)) * roi.d <= best;
}

void CandidateScore::score(std::vector<Roi>& rois) const {
  double largest = 0;
  for (const Roi& roi : rois)
    if (roi.compared) largest = std::max(largest, roi.t);
  for (Roi& roi : rois) {
    const double g = gamma(roi.d);
    const double t_N = roi.compared ? (largest > 0 ? roi.t / largest : 0) : 1;
    roi.s = (1 - g) * roi.d + g * t_N;
  }
}

}  // namespace heartservo::tracking
