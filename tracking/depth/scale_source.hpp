#pragma once
// The three ways to know a region's distance once.
#include <functional>

#include "tracking/depth/scale_reference.hpp"
#include "tracking/depth/stereo_match.hpp"

namespace heartservo::tracking {

struct Frame;

/// Asked with the frames and tracks of the region from the first on, until what it says validates.
using ScaleSource = std::function<ScaleReference(const Frame&, const Track&)>;

/// The distance is known from elsewhere: told, or the robot's when its tool touches the tissue.
ScaleSource known_scale(const ScaleReference& scale);

/// A square landmark lies on or beside the region in the first frame; `picked`: its corners there, px, by hand;
/// `edge_ratio`: see square_refinement.hpp, 0 takes the corners as they are.
ScaleSource landmark_scale(const Camera& camera, const Quad& picked, double side_m, double edge_ratio,
                           double corner_sigma_px);

/// The first stereo frame. Throws ConfigError where camera or options do not validate.
ScaleSource stereo_scale(const StereoCamera& camera, const StereoOptions& options);

}  // namespace heartservo::tracking
