#pragma once
// ViSP's template trackers as peers (Benhimane & Malis 2004; Baker & Matthews 2004; Irani & Anandan 1998; Dame &
// Marchand 2010, as in Marchand, Uchiyama & Spindler, TVCG 2016): an adapter that hands vpTemplateTracker the whole
// 8-bit picture and the start values of our shell, and judges the result with our template (template_judge.hpp),
// because ViSP's trackers do not notice a loss themselves.
//
// Settings: the SL(3) warp (SSDESM throws with the plain one), every point, one level (their pyramid smooths
// perspective away), a stopping threshold of 1e-7 on the cost and, where it can be, no damping: the default lambda of
// 0.001 stalls the perspective terms. Mutual information steps by Newton; with its default, Levenberg-Marquardt,
// tests/bench/tracker_bench.cpp gives 0.85 / 0.14 px at 40 / 80 px against 0.42 / 0.43. ViSP reads the picture as
// it is: with these, give PlanarTracker no camera, as registry.cpp does; under a lens with distortion they fit a
// homography to what is none.
//
// Making one switches the error handler of the GNU Scientific Library off for the whole process: it would end it.
//
// Limits: every align() costs a filter over the whole picture; ViSP is not asked at all where the template does
// not even correlate with the start place (kWorthTrying in the source), which saves seconds on lost frames.
#include <memory>

#include "tracking/planar/patch_aligner.hpp"

namespace heartservo::tracking {

enum class VispMethod {
  ESM,   ///< vpTemplateTrackerSSDESM
  IC,    ///< vpTemplateTrackerSSDInverseCompositional
  ZNCC,  ///< vpTemplateTrackerZNCCInverseCompositional
  MI,    ///< vpTemplateTrackerMIInverseCompositional
};

std::unique_ptr<PatchAligner> make_visp_aligner(VispMethod method);

}  // namespace heartservo::tracking
