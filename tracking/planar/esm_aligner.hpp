#pragma once
// Efficient second-order minimisation of the grey difference between template and picture (Benhimane & Malis, IROS
// 2004), with gain and bias of the illumination as two more unknowns and Tukey weights against glare and occlusion.
#include <memory>

#include "tracking/planar/patch_aligner.hpp"

namespace heartservo::tracking {

struct EsmOptions {
  int max_iterations = 15;     ///< per pyramid level
  double step_px = 0.01;       ///< stop when no corner moves further than this
  double affine_sigma = 0.05;  ///< by how much the region's shape may change between frames: rotation, stretch, scale
  double perspective_sigma = 0.003;  ///< the same for the perspective terms (1 / half the longer side)
};

std::unique_ptr<PatchAligner> make_esm_aligner(const EsmOptions& options);

}  // namespace heartservo::tracking
