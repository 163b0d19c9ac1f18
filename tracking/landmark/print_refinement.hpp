#pragma once
// The corners of a square plate whose print is known, from all its pixels in one picture: the dense pose, projected.
// An edge blurred by lens and tissue light is found some hundredths of a pixel off, the same on all sides, so that four
// refined corners tell a distance that is wrong by parts in a thousand, for as long as a tracker follows them.
#include <opencv2/core/mat.hpp>

#include "tracking/camera/camera.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::tracking {

/// `corners` (px, distorted, clockwise from top left) must be right to about a pixel, as refine_square() leaves them.
/// `plate`: the print, as landmark_template.hpp wants it; `side_m` of its outline. Where the grey levels give no pose,
/// the plate mostly covered or another one, `corners` come back unchanged.
Quad refine_by_print(const cv::Mat& grey, const Camera& camera, const Quad& corners, const cv::Mat& plate,
                     double side_m);

}  // namespace heartservo::tracking
