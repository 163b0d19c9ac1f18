#include "sim/endoscope/shading.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

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

constexpr int kBlock = 128;  // pixels; what is kept of them stays in the first-level cache

struct Block {
  std::int32_t at[kBlock];                     // of the texel above and left of the pixel
  float fx[kBlock], fy[kBlock];                // how far right and below of it the pixel lies
  std::uint64_t upper[kBlock], lower[kBlock];  // two neighbours each, the left one in the lower half
};

HEARTSERVO_SIMD
void place(const float* __restrict x, const float* __restrict y, int n, int size, Block& __restrict block) {
  const float middle = 0.5f * static_cast<float>(size - 1), last = static_cast<float>(size - 1);
  for (int i = 0; i < n; ++i) {
    // Mirrored at the texture's edges; the comparisons are written so that a NaN becomes 0.
    float tx = last - std::fabs(last - std::fabs(x[i] + middle)),
          ty = last - std::fabs(last - std::fabs(y[i] + middle));
    tx = tx > 0 ? tx : 0, ty = ty > 0 ? ty : 0;
    int ix = static_cast<int>(tx), iy = static_cast<int>(ty);
    ix = ix < size - 2 ? ix : size - 2, iy = iy < size - 2 ? iy : size - 2;
    block.fx[i] = tx - static_cast<float>(ix), block.fy[i] = ty - static_cast<float>(iy);
    block.at[i] = iy * size + ix;
  }
}

// Word by word, and compiled for the baseline, which has no gather instruction: that needs four times as long.
void fetch(const std::uint32_t* texels, int n, int size, Block& block) {
  for (int i = 0; i < n; ++i) {
    const std::uint32_t* texel = texels + block.at[i];
    std::memcpy(&block.upper[i], texel, sizeof(std::uint64_t));
    std::memcpy(&block.lower[i], texel + size, sizeof(std::uint64_t));
  }
}

HEARTSERVO_SIMD
void shade(const ShadingConstants& constants, const Block& __restrict block, const float* __restrict light,
           const float* __restrict ha, const float* __restrict hb, int n, float* __restrict out) {
  const float specular = constants.specular_grey / 63, sharpness = constants.inverse_roughness2;
  for (int i = 0; i < n; ++i) {
    const float fx = block.fx[i], fy = block.fy[i];
    const auto t00 = static_cast<std::uint32_t>(block.upper[i]), t01 = static_cast<std::uint32_t>(block.upper[i] >> 32),
               t10 = static_cast<std::uint32_t>(block.lower[i]), t11 = static_cast<std::uint32_t>(block.lower[i] >> 32);
    const float grey = HEARTSERVO_BILINEAR(grey_of) * 0.25f;
    const float slope_a = (HEARTSERVO_BILINEAR(slope_a_of) - 128) * TissueTexture::kSlopeStep;
    const float slope_b = (HEARTSERVO_BILINEAR(slope_b_of) - 128) * TissueTexture::kSlopeStep;
    const float gloss = HEARTSERVO_BILINEAR(gloss_of);
    // A bump's lit side is brighter; lamp and camera are so close that the mirror slope stands for the light's.
    const float relief = 1 + slope_a * ha[i] + slope_b * hb[i];
    const float da = slope_a - ha[i], db = slope_b - hb[i];
    const float lobe = 1 / (1 + (da * da + db * db) * sharpness), lobe2 = lobe * lobe;
    out[i] = light[i] * (grey * relief + specular * gloss * lobe2 * lobe2);
  }
}

}  // namespace

void shade_row(const ShadingConstants& constants, const float* channels, int stride, int width, float* out) {
  static_assert(std::endian::native == std::endian::little);
  Block block;
  for (int first = 0; first < width; first += kBlock) {
    const int n = std::min(kBlock, width - first);
    const float* x = channels + first;
    place(x, x + stride, n, constants.size, block);
    fetch(constants.texels, n, constants.size, block);
    shade(constants, block, x + 2 * stride, x + 3 * stride, x + 4 * stride, n, out + first);
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
