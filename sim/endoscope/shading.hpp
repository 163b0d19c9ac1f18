#pragma once
// The two loops over every pixel: tissue under light, and the sensor.
#include <cstdint>

#include "sim/endoscope/tissue_texture.hpp"

namespace heartservo::sim {

/// What shade_row() needs to know about texture and gloss.
struct ShadingConstants {
  const std::uint32_t* texels;
  int size;             ///< texels along each side
  float specular_grey;  ///< 0: none
  float inverse_roughness2;
};

/// One row: `channels` holds SurfaceNodes::kChannels rows of `stride` values; grey levels before the sensor go to
/// `out`.
void shade_row(const ShadingConstants& constants, const float* channels, int stride, int width, float* out);

/// Sensor: round(gain * light + bias + noise), clamped to 0..255.
void expose_row(const float* light, const float* noise, float gain, float bias, int width, std::uint8_t* grey);

}  // namespace heartservo::sim
