#pragma once
// Corners picked by hand become subpixel corners (section 2.2): the four sides of a square plate are found as edges in
// the picture, fitted as lines where they are straight (the undistorted plane), and intersected.
#include <opencv2/core/mat.hpp>

#include "tracking/camera/camera.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::tracking {

struct SquareRefinement {
  bool refined = false;    ///< false: some side was not found; the corners are those given
  Quad corners{};          ///< px, distorted, clockwise from top left
  double edge_rms_px = 0;  ///< of the edge points from their lines
};

/// `picked` are the corners of the plate and may be wrong by up to `search_px`. The edge looked for is a concentric
/// square of `edge_ratio` times the plate's side, lighter outside than inside: paint against paint, so that it looks
/// the same on any tissue.
SquareRefinement refine_square(const cv::Mat& grey, const Camera& camera, const Quad& picked, double edge_ratio,
                               double search_px = 3);

}  // namespace heartservo::tracking
