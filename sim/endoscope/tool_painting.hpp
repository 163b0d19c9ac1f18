#pragma once
// Loops over a row's pixels that paint the tool.
#include <cstdint>

namespace heartservo::sim {

inline constexpr int kMarkerTexels = 300;    ///< along each side of the marker's texture, margin included
inline constexpr double kMarkerScale = 128;  ///< texels per half side

struct ShaftConstants {
  float tip[3], direction[3];  ///< camera frame, m; direction of unit length
  float radius, taper;         ///< m
  float nearest;               ///< m; nothing is drawn closer to the camera
  float focal_px;
  float reference_depth;  ///< m; where the light is 1
  float brightness;
};

/// Cover (0..1) and grey level of the shaft on rays (x, y, 1).
void shade_shaft(const ShaftConstants& constants, const float* x, const float* y, int count, float* cover, float* grey);

struct MarkerConstants {
  const float* texels;  ///< kMarkerTexels^2 grey levels, then as many covers
  float axes[3][3];     ///< the plate's x, y and normal, camera frame
  float centre[3];      ///< of the plate along these, in half sides
  float light;
};

/// Lays the marker over what `cover` and `grey` hold.
void shade_marker(const MarkerConstants& constants, const float* x, const float* y, int count, float* cover,
                  float* grey);

}  // namespace heartservo::sim
