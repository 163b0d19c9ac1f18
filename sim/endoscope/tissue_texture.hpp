#pragma once
// What the heart's surface looks like: grey, relief and gloss over the material coordinates.
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "sim/endoscope/huge_pages.hpp"
#include "sim/heart/landmark_options.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

struct TextureOptions {
  int size = 2048;
  double extent_m = 0.08;
  double fibre_angle_rad = 0.6;
  double vessels = 1;
  double fat = 1;
  double relief = 1;
  double contrast = 1;

  void fields(FieldVisitor& v) {
    v.field({"size", "texels", "texels along each side", 256, 8192}, size);
    v.field({"extent_m", "m", "side of the textured square; beyond it the texture is mirrored", 0.02, 0.3}, extent_m);
    v.field({"fibre_angle_rad", "rad", "direction of the muscle's fibres, clockwise in the picture", -3.2, 3.2},
            fibre_angle_rad);
    v.field({"vessels", "", "number of vessels, relative", 0, 3}, vessels);
    v.field({"fat", "", "share of fat, relative", 0, 2}, fat);
    v.field({"relief", "", "height of the wet surface's bumps, relative", 0, 3}, relief);
    v.field({"contrast", "", "of the tissue's grey levels, relative; low values make a homogeneous heart", 0, 2},
            contrast);
  }
};

/// Texel (row j, column i) of a size x size texture lies at a = (i - (size - 1) / 2) / density, b likewise by rows.
/// Blurred so that a camera with about 10.8 px per mm does not alias, symmetrically, so that edges stay where they are.
class TissueTexture {
 public:
  /// Procedural heart: muscle grain, fat, branching vessels, fine noise, wet relief; `landmarks` painted in. The same
  /// seed gives the same texture.
  static TissueTexture procedural(const TextureOptions& options, const std::vector<LandmarkOptions>& landmarks,
                                  std::uint64_t seed);

  /// From given planes of equal square size, all CV_32FC1: grey 0..255 and, unless empty, the relief's slopes
  /// (d height / d a, d height / d b; height towards the camera) and gloss 0..1. Without them flat and matt.
  static TissueTexture from_planes(const cv::Mat& grey, double texels_per_m, const cv::Mat& slope_a = {},
                                   const cv::Mat& slope_b = {}, const cv::Mat& gloss = {});

  int size() const { return size_; }
  double texels_per_m() const { return texels_per_m_; }

  /// size^2 texels, row by row: grey in bits 22-31 (quarter levels), slopes in bits 14-21 and 6-13 (kSlopeStep from
  /// -128), gloss in bits 0-5.
  const std::uint32_t* texels() const { return texels_.data(); }

  static constexpr float kSlopeStep = 1 / 128.f;

 private:
  int size_ = 0;
  double texels_per_m_ = 0;
  std::vector<std::uint32_t, HugePageAllocator<std::uint32_t>> texels_;
};

}  // namespace heartservo::sim
