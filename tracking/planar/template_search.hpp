#pragma once
#include <Eigen/Core>
#include <vector>

#include "tracking/planar/image_pyramid.hpp"
#include "tracking/planar/patch.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::tracking {

/// The coarsest pyramid level at which a template of this side still has about ten points.
int search_level(double side_px, int levels);

struct FoundPlace {
  Eigen::Vector2d centre;  ///< px of the full picture
  double correlation = 0;  ///< zero-mean normalised
};

/// The best matches of a template, drawn into the picture's axes as `corners` shows it; best first, no two nearer than
/// half the template. Only places within `radius_px` of `around`. Glare speaks neither for nor against a place.
std::vector<FoundPlace> find_template(const Patch& patch, const Quad& corners, const PyramidLevel& picture,
                                      const Eigen::Vector2d& around, double radius_px, int count);

}  // namespace heartservo::tracking
