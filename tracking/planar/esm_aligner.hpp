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
  double gain_change = 0.5;   ///< the light changes no more between frames; beside the place a plain fit is no gain
  double cell_px = 0;         ///< above 0: for regions bent by a SplineBend of such cells, which is kept as it is
};

std::unique_ptr<PatchAligner> make_esm_aligner(const EsmOptions& options);

}  // namespace heartservo::tracking
