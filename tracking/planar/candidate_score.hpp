#pragma once
// The score of the candidates of composite tracking, eq. (11) to (14) of Sauvee et al., section 3.2.
#include <string>
#include <vector>

namespace heartservo::tracking {

/// One candidate region of interest.
struct Roi {
  double d = 1;           ///< squared grey differences to the template, normalised to [0, 1]
  double t = 0;           ///< texture distance to the template, eq. (10); of those compared
  double s = 1;           ///< eq. (12): the lower, the better
  bool compared = false;  ///< by texture
};

/// gamma of eq. (12), the weight of texture; lambda = 1 - gamma.
enum class Weighting {
  FIXED,
  EQ13,  ///< gamma = d: texture counts where the greys do not fit
  EQ14,  ///< gamma = exp(-d / (1 - d)): texture counts where they do
};

/// "fixed", "eq13", "eq14"; anything else is FIXED.
Weighting weighting_of(const std::string& name);

class CandidateScore {
 public:
  CandidateScore(Weighting weighting, double fixed_gamma) : weighting_(weighting), fixed_gamma_(fixed_gamma) {}

  double gamma(double d) const;

  /// Sets `compared` of those whose texture has to be looked at: the others lose however alike their texture is, since
  /// lambda d <= s <= lambda d + gamma whatever the texture distance. These ROIs are those of eq. (11).
  void choose(std::vector<Roi>& rois) const;

  /// Sets s from d and t: eq. (11) over those compared, then eq. (12). The others get s = lambda d + gamma.
  void score(std::vector<Roi>& rois) const;

 private:
  Weighting weighting_;
  double fixed_gamma_;
};

}  // namespace heartservo::tracking
