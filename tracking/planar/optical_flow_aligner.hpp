#pragma once
// Optical flow, as the paper compares with (section 4.4, Table 5, Fig. 7): corners of the region in the picture before
// (Shi & Tomasi 1994) are followed by pyramidal Lucas-Kanade (Bouguet 2000; cv::calcOpticalFlowPyrLK), there and back;
// a homography by RANSAC through those that return takes the region from one picture to the next.
//
// The homographies are chained, so their errors add up: it drifts, by nature, and the template is only used to judge it
// (template_judge.hpp) and to find the region again after a loss, when the chain begins anew at the picture in which
// the region was learnt. Limits: needs 8 corners that return; uniform change of light within a frame is not modelled.
#include <memory>

#include "tracking/planar/patch_aligner.hpp"

namespace heartservo::tracking {

struct OpticalFlowOptions {
  int max_points = 120;    ///< corners followed
  int window_px = 15;      ///< side of the window compared around a corner
  double return_px = 0.5;  ///< a corner followed there and back must come back to within this
  double inlier_px = 1.0;  ///< RANSAC: a corner agrees with a homography to within this
};

std::unique_ptr<PatchAligner> make_optical_flow_aligner(const OpticalFlowOptions& options);

}  // namespace heartservo::tracking
