#pragma once
// Tracking by zero-mean normalised correlation, as the paper compares with (section 4.4, Table 5, Fig. 7): the
// rectangle around the region, as it was learnt, is compared with every integer place of the search window around the
// prediction (cv::matchTemplate, TM_CCOEFF_NORMED); a parabola through the peak and its neighbours, in x and in y,
// gives the place between pixels.
//
// Translation only, like the paper's: it does not see rotation, scale or perspective and diverges under them. The
// correlation reported is measured at the place found by the judge of all trackers (template_judge.hpp), so it falls
// with the unmodelled motion. Limits: of a region that is not an upright rectangle the surroundings inside its
// bounding box take part; with a camera the lens's distortion is taken into account for the centre's move only.
#include <memory>

#include "tracking/planar/patch_aligner.hpp"

namespace heartservo::tracking {

struct CorrelationOptions {
  double search_px = 24;  ///< how far from the start, in x and in y, to search
};

std::unique_ptr<PatchAligner> make_correlation_aligner(const CorrelationOptions& options);

}  // namespace heartservo::tracking
