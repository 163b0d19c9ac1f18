#pragma once
#include "tracking/planar/patch.hpp"

namespace heartservo::tracking {

/// Standard deviation of the noise of a template, grey levels, from the differences that smooth surfaces and straight
/// edges do not have (Immerkaer, Computer Vision and Image Understanding 64(2), 1996). Over usable points; 0 where there
/// are none. Texture as fine as a pixel counts as noise.
double noise_of(const Patch& patch);

}  // namespace heartservo::tracking
