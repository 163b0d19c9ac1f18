#pragma once
// Composite tracking (Sauvee, Noce, Poignet, Triboulet, Dombre 2007, section 3.2): candidate regions around the
// predicted place are compared with the template by squared grey differences and by texture (candidate_search.hpp); the
// best of them start the robust minimisation that recovers the homography (esm_aligner.hpp).
#include <memory>

#include "tracking/planar/composite_options.hpp"
#include "tracking/planar/esm_aligner.hpp"
#include "tracking/planar/patch_aligner.hpp"

namespace heartservo::tracking {

std::unique_ptr<PatchAligner> make_composite_aligner(const CompositeOptions& options, const EsmOptions& esm);

}  // namespace heartservo::tracking
