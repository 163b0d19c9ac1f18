#include "sim/endoscope/shading.hpp"

#include <cmath>

#include "sim/endoscope/surface_nodes.hpp"
#include "tracking/settings/target_clones.hpp"

namespace heartservo::sim {
namespace {

/// Weights 0..1 of two neighbours mixed, twice: bilinear interpolation.
#define HEARTSERVO_BILINEAR(get)           \
  (get(t00) + fx * (get(t01) - get(t00)) + \
   fy * (get(t10) + fx * (get(t11) - get(t10)) - get(t00) - fx * (get(t01) - get(t00))))

inline __attribute__((always_inline)) float grey_of(std::uint32_t t) {
  return static_cast<float>(static_cast<int>(t >> 22));
}
inline __attribute__((always_inline)) float slope_a_of(std::uint32_t t) {
  return static_cast<float>(static_cast<int>(t >> 14 & 255));
}
inline __attribute__((always_inline)) float slope_b_of(std::uint32_t t) {
  return static_cast<float>(static_cast<int>(t >> 6 & 255));
}
inline __attribute__((always_inline)) float gloss_of(std::uint32_t t) {
  return static_cast<float>(static_cast<int>(t & 63));
}

}  // namespace

HEARTSERVO_SIMD
void shade_row(const ShadingConstants& constants, const float* channels, int stride, int width, float* __restrict out) {
  const std::uint32_t* __restrict texels = constants.texels;
  const int size = constants.size;
  const float middle = 0.5f * static_cast<float>(size - 1), last = static_cast<float>(size - 1);
  const float specular = constants.specular_grey / 63, sharpness = constants.inverse_roughness2;
  const float *x = channels, *y = x + stride, *shade = y + stride, *ha = shade + stride, *hb = ha + stride;
  for (int i = 0; i < width; ++i) {
    // Mirrored at the texture's edges; the comparisons are written so that a NaN becomes 0.
    float tx = last - std::fabs(last - std::fabs(x[i] + middle)),
          ty = last - std::fabs(last - std::fabs(y[i] + middle));
    tx = tx > 0 ? tx : 0, ty = ty > 0 ? ty : 0;
    int ix = static_cast<int>(tx), iy = static_cast<int>(ty);
    ix = ix < size - 2 ? ix : size - 2, iy = iy < size - 2 ? iy : size - 2;
    const float fx = tx - static_cast<float>(ix), fy = ty - static_cast<float>(iy);
    const int at = iy * size + ix;
    const std::uint32_t t00 = texels[at], t01 = texels[at + 1], t10 = texels[at + size], t11 = texels[at + size + 1];
    const float grey = HEARTSERVO_BILINEAR(grey_of) * 0.25f;
    const float slope_a = (HEARTSERVO_BILINEAR(slope_a_of) - 128) * TissueTexture::kSlopeStep;
    const float slope_b = (HEARTSERVO_BILINEAR(slope_b_of) - 128) * TissueTexture::kSlopeStep;
    const float gloss = HEARTSERVO_BILINEAR(gloss_of);
    // A bump's lit side is brighter; lamp and camera are so close that the mirror slope stands for the light's.
    const float relief = 1 + slope_a * ha[i] + slope_b * hb[i];
    const float da = slope_a - ha[i], db = slope_b - hb[i];
    const float lobe = 1 / (1 + (da * da + db * db) * sharpness), lobe2 = lobe * lobe;
    out[i] = shade[i] * (grey * relief + specular * gloss * lobe2 * lobe2);
  }
}

HEARTSERVO_SIMD
void expose_row(const float* light, const float* noise, float gain, float bias, int width,
                std::uint8_t* __restrict grey) {
  for (int i = 0; i < width; ++i) {
    float value = gain * light[i] + bias + noise[i] + 0.5f;
    value = value > 0 ? value : 0;
    value = value < 255 ? value : 255;
    grey[i] = static_cast<std::uint8_t>(static_cast<int>(value));
  }
}

}  // namespace heartservo::sim
