#pragma once
// Efficient second-order minimisation of the grey difference between template and picture (Benhimane & Malis, IROS
// 2004), with gain and bias of the illumination as two more unknowns and Tukey weights against glare and occlusion.
#include <memory>

#include "tracking/planar/patch_aligner.hpp"

namespace heartservo::tracking {

struct EsmOptions {
  int max_iterations = 15;  ///< per pyramid level
  double step_px = 0.01;    ///< stop when no corner moves further than this
};

std::unique_ptr<PatchAligner> make_esm_aligner(const EsmOptions& options);

}  // namespace heartservo::tracking
