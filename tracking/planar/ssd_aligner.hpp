#pragma once
// The classical SSD tracker the paper compares with (section 4.4, Table 5, Fig. 7): forward-compositional Gauss-Newton
// (Lucas & Kanade 1981; Baker & Matthews, IJCV 2004) on the sum of squared grey differences between template and
// picture,
//
//     min over d of sum ( I(G exp(d) x) - T(x) )^2,   G <- G exp(d),   J = the gradient of the warped picture alone
//
// over the same SL(3) homography, sampling and pyramid as `esm`. It has no gain and bias, no weights and no
// second-order step: a change of light, glare and occlusion pull it away, and its convergence basin is narrower.
// Nothing else is held back; prediction, loss detection and re-acquisition are the ones of every tracker here
// (planar_tracker.hpp).
#include <memory>

#include "tracking/planar/patch_aligner.hpp"

namespace heartservo::tracking {

struct SsdOptions {
  int max_iterations = 15;  ///< per pyramid level
  double step_px = 2e-3;    ///< stop when no corner moves further than this
};

std::unique_ptr<PatchAligner> make_ssd_aligner(const SsdOptions& options);

}  // namespace heartservo::tracking
