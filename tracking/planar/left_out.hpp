#pragma once
// For people to look at: which pixels of the region an alignment does not rest on.
#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "tracking/planar/image_pyramid.hpp"
#include "tracking/planar/patch_aligner.hpp"

namespace heartservo::tracking {

/// Sets the pixels of `mask` (CV_8UC1, the size of the picture) to 255 where a point of the aligner's template is
/// unusable, or the picture is saturated or differs by more than Tukey's bound. `picture`: level 0.
void mark_left_out(const PyramidLevel& picture, const Camera& camera, const PatchAligner& aligner,
                   const Alignment& alignment, cv::Mat& mask);

}  // namespace heartservo::tracking
