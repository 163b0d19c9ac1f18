#pragma once
// The unlit look of bare heart tissue, before landmarks and blur.
#include <cstdint>
#include <opencv2/core.hpp>

#include "sim/endoscope/tissue_texture.hpp"

namespace heartservo::sim {

/// Square planes of options.size, CV_32FC1.
struct TissueLayers {
  cv::Mat grey;    ///< 0..255
  cv::Mat height;  ///< m, relief of the wet surface, towards the camera
  cv::Mat gloss;   ///< 0..1
  cv::Mat fat;     ///< share of fat, 0..1; what is neither fat nor vessel is muscle
  cv::Mat vessel;  ///< share of vessel, 0..1
};

TissueLayers paint_tissue(const TextureOptions& options, std::uint64_t seed);

/// Smooth random field of about unit standard deviation whose features are `wavelength` texels apart.
cv::Mat smooth_noise(int size, double wavelength, cv::RNG& random);

/// Branching, tapering vessels: CV_32FC1, 0 outside, 1 inside, about a texel of soft edge.
cv::Mat paint_vessels(int size, double texels_per_m, double amount, cv::RNG& random);

}  // namespace heartservo::sim
