#pragma once
// A region that bends: the homography of the efficient second-order minimisation, then the control points of a spline
// over the region (spline_bend.hpp) by the same kind of steps, with a prior that bending is smooth. The light is a
// gain that varies as smoothly over the region, and a bias. Tukey weights leave glare and tools out.
#include <memory>

#include "tracking/planar/patch_aligner.hpp"

namespace heartservo::tracking {

struct DeformableOptions {
  int max_iterations = 15;       ///< of the homography, per pyramid level
  int bend_iterations = 8;       ///< of the spline
  double step_px = 0.02;         ///< stop when no control point moves further than this
  double cell_px = 12;           ///< of the spline, about
  double bend_sigma_px = 0.4;    ///< second differences of the control points, a priori
  double change_sigma_px = 1.0;  ///< move of a control point against its neighbours' from frame to frame, a priori
  double shade_sigma = 0.1;      ///< second differences of the gain, a priori
  double gain_change = 0.5;      ///< the light changes no more between frames
};

std::unique_ptr<PatchAligner> make_deformable_aligner(const DeformableOptions& options);

}  // namespace heartservo::tracking
