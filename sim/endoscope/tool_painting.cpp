#include "sim/endoscope/tool_painting.hpp"

#include <cmath>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::sim {

HEARTSERVO_SIMD
void shade_shaft(const ShaftConstants& constants, const float* x, const float* y, int count, float* __restrict cover,
                 float* __restrict grey) {
  const ShaftConstants k = constants;
  const float tx = k.tip[0], ty = k.tip[1], tz = k.tip[2], dx = k.direction[0], dy = k.direction[1],
              dz = k.direction[2];
  const float dt = dx * tx + dy * ty + dz * tz;
  const float cx = ty * dz - tz * dy, cy = tz * dx - tx * dz, cz = tx * dy - ty * dx;  // tip x direction
  for (int i = 0; i < count; ++i) {
    // Closest approach of the ray w = (x, y, 1) and the axis tip + s direction.
    const float w2 = x[i] * x[i] + y[i] * y[i] + 1, wd = x[i] * dx + y[i] * dy + dz, wt = x[i] * tx + y[i] * ty + tz;
    float n2 = w2 - wd * wd;
    n2 = n2 > 1e-6f ? n2 : 1e-6f;
    const float n = std::sqrt(n2);
    const float s = (wt * wd - dt * w2) / n2;
    const float across = (x[i] * cx + y[i] * cy + cz) / n;  // signed distance of ray and axis
    float part = s / k.taper;
    part = part > 0 ? part : 0;
    part = part < 1 ? part : 1;
    const float radius = k.radius * part * (2 - part), z = tz + s * dz;
    float c = (radius - std::fabs(across)) * k.focal_px / z + 0.5f;
    c = c > 0 ? c : 0;
    c = c < 1 ? c : 1;
    cover[i] = (s > 0) & (z > k.nearest) ? c : 0;
    // A cylinder's normal turns from edge to edge; metal shows a bright streak off its middle.
    const float e = across / (radius > 1e-6f ? radius : 1e-6f);
    float facing = 1 - e * e;
    facing = std::sqrt(facing > 0 ? facing : 0);
    const float off = e + 0.25f, streak = 1 / (1 + 40 * off * off);
    const float rings = 0.5f + 0.5f * std::fabs(2 * (s * 160 - std::floor(s * 160)) - 1);  // machined, 6 mm apart
    const float ring = rings > 0.53f ? 1.f : 0.7f;
    const float fall = k.reference_depth / z;
    float light = fall * fall;
    light = light < 1.6f ? light : 1.6f;
    grey[i] = k.brightness * light * ring * (22 + 75 * facing + 85 * streak);
  }
}

HEARTSERVO_SIMD
void shade_marker(const MarkerConstants& constants, const float* x, const float* y, int count, float* __restrict cover,
                  float* __restrict grey) {
  const MarkerConstants k = constants;
  const float* __restrict texels = k.texels;
  constexpr float kMiddle = 0.5f * (kMarkerTexels - 1), kScale = static_cast<float>(kMarkerScale);
  constexpr float kLast = kMarkerTexels - 2 + 0.999f;
  for (int i = 0; i < count; ++i) {
    // where the ray (x, y, 1) meets the plate
    const float ahead = x[i] * k.axes[2][0] + y[i] * k.axes[2][1] + k.axes[2][2];
    const float depth = k.centre[2] / (ahead > 0.05f ? ahead : 0.05f);
    const float along = x[i] * k.axes[0][0] + y[i] * k.axes[0][1] + k.axes[0][2];
    const float across = x[i] * k.axes[1][0] + y[i] * k.axes[1][1] + k.axes[1][2];
    float p = (along * depth - k.centre[0]) * kScale + kMiddle, q = (across * depth - k.centre[1]) * kScale + kMiddle;
    p = p > 0 ? p : 0, q = q > 0 ? q : 0;
    p = p < kLast ? p : kLast, q = q < kLast ? q : kLast;  // the margin is uncovered
    const int ip = static_cast<int>(p), iq = static_cast<int>(q), at = iq * kMarkerTexels + ip;
    const float fp = p - static_cast<float>(ip), fq = q - static_cast<float>(iq);
    auto bilinear = [&](const float* t) __attribute__((always_inline)) {
      const float upper = t[at] + fp * (t[at + 1] - t[at]);
      const float lower = t[at + kMarkerTexels] + fp * (t[at + kMarkerTexels + 1] - t[at + kMarkerTexels]);
      return upper + fq * (lower - upper);
    };
    const float a = bilinear(texels + kMarkerTexels * kMarkerTexels), level = k.light * bilinear(texels);
    // Over the shaft, over the picture.
    const float both = a + cover[i] * (1 - a);
    grey[i] = both > 0 ? (a * level + (1 - a) * cover[i] * grey[i]) / both : 0;
    cover[i] = both;
  }
}

}  // namespace heartservo::sim
