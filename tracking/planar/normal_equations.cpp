#include "tracking/planar/normal_equations.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

namespace {

constexpr std::size_t kBlock = 256;         // points per block: the block's Jacobian stays in the first-level cache
constexpr int kRows = 11;                   // 8 + gain + bias + residual
constexpr std::size_t kMedianPoints = 512;  // enough for a scale estimate

using Block = std::array<std::array<float, kBlock>, kRows>;

// `gain_offset` has n elements, or, with kOffset false, is not looked at.
template <bool kOffset>
inline __attribute__((always_inline)) void residuals(const float* __restrict grey, const float* __restrict inside,
                                                     const float* __restrict reference,
                                                     const float* __restrict gain_offset, std::size_t n, float gain,
                                                     float bias, float* __restrict residual, float* __restrict clear) {
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    float g = gain;
    if constexpr (kOffset) g += gain_offset[i];
    residual[i] = g * grey[i] + bias - reference[i];
    clear[i] = inside[i] * (grey[i] < kSaturatedGrey ? 1.0F : 0.0F);
  }
}
HEARTSERVO_SIMD void residual_pass(const Patch& patch, float gain, float bias, AlignmentBuffers& b) {
  residuals<false>(b.grey.data(), b.inside.data(), patch.grey.data(), nullptr, patch.size(), gain, bias,
                   b.residual.data(), b.clear.data());
}
HEARTSERVO_SIMD void residual_pass_offset(const Patch& patch, float gain, float bias, const float* gain_offset,
                                          AlignmentBuffers& b) {
  residuals<true>(b.grey.data(), b.inside.data(), patch.grey.data(), gain_offset, patch.size(), gain, bias,
                  b.residual.data(), b.clear.data());
}

// A point counts when it and its four neighbours, which its gradient is made of, are clear of glare.
HEARTSERVO_SIMD void weight_row(const float* __restrict clear, const float* __restrict usable, std::ptrdiff_t stride,
                                std::ptrdiff_t n, float* __restrict weight) {
#pragma omp simd
  for (std::ptrdiff_t i = 0; i < n; ++i)
    weight[i] = usable[i] * clear[i] * clear[i - 1] * clear[i + 1] * clear[i - stride] * clear[i + stride];
}

HEARTSERVO_SIMD float tukey_pass(const float* __restrict residual, float* __restrict weight, std::size_t n,
                                 float inverse_scale) {
  float sum = 0;
#pragma omp simd reduction(+ : sum)
  for (std::size_t i = 0; i < n; ++i) {
    const float e = residual[i] * inverse_scale;
    const float t = std::max(0.0F, 1.0F - e * e);
    weight[i] *= t * t;
    sum += weight[i];
  }
  return sum;
}

struct RowInput {
  const float *grey, *residual, *weight, *template_x, *template_y;
  std::size_t stride;
  float x0, step, y, share, half_gain;  // half_gain: (1 - share) * 1/2 (central difference) * gain / step
};

// Jacobian rows of `n` points of one template row, weighted by sqrt(w).
HEARTSERVO_SIMD void jacobian_row(const RowInput& in, std::size_t n, std::size_t at, Block& J) {
  float* __restrict j[kRows];
  for (int k = 0; k < kRows; ++k) j[k] = J[static_cast<std::size_t>(k)].data() + at;
#pragma omp simd
  for (std::size_t i = 0; i < n; ++i) {
    const float root = std::sqrt(in.weight[i]);
    const float x = in.x0 + static_cast<float>(i) * in.step, y = in.y;
    const float* g = in.grey + i;
    const float gx = root * (in.share * in.template_x[i] + in.half_gain * (g[1] - g[-1]));
    const float gy = root * (in.share * in.template_y[i] +
                             in.half_gain * (g[in.stride] - g[-static_cast<std::ptrdiff_t>(in.stride)]));
    const float gxx = gx * x, gyy = gy * y, radial = gxx + gyy;
    j[0][i] = gx;
    j[1][i] = gy;
    j[2][i] = gx * y;
    j[3][i] = gy * x;
    j[4][i] = gxx - gyy;
    j[5][i] = radial;
    j[6][i] = -x * radial;
    j[7][i] = -y * radial;
    j[8][i] = root * g[0];
    j[9][i] = root;
    j[10][i] = root * in.residual[i];
  }
}

HEARTSERVO_SIMD void add_products(const Block& J, std::size_t n, float* __restrict sums) {
  int k = 0;
  for (std::size_t a = 0; a + 1 < kRows; ++a)
    for (std::size_t b = a; b < kRows; ++b, ++k) {
      const float *p = J[a].data(), *q = J[b].data();
      float sum = 0;
#pragma omp simd reduction(+ : sum)
      for (std::size_t i = 0; i < n; ++i) sum += p[i] * q[i];
      sums[k] = sum;
    }
}

void accumulate(const Block& J, std::size_t n, AlignmentPass& pass) {
  float sums[kRows * (kRows + 1) / 2];
  add_products(J, n, sums);
  int k = 0;
  for (int a = 0; a + 1 < kRows; ++a)
    for (int b = a; b < kRows; ++b, ++k) {
      if (b < 10)
        pass.JtJ(a, b) += sums[k];
      else
        pass.Jtr(a) += sums[k];
    }
}

// Robust scale from at most kMedianPoints residuals, evenly spread.
float robust_noise(AlignmentBuffers& b, std::size_t n) {
  const std::size_t step = std::max<std::size_t>(1, n / kMedianPoints) | 1;  // odd: does not run along a column
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; i += step)
    if (b.weight[i] > 0) b.sample[count++] = std::abs(b.residual[i]);
  if (count == 0) return 0;
  const auto middle = b.sample.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(b.sample.begin(), middle, b.sample.begin() + static_cast<std::ptrdiff_t>(count));
  return 1.4826F * *middle;
}

}  // namespace

void AlignmentBuffers::resize(std::size_t n) {
  for (auto* v : {&grey, &inside, &clear, &residual, &weight, &sample}) v->resize(std::max(v->size(), n));
}

void weigh_points(const Patch& patch, const Light& light, AlignmentBuffers& b, AlignmentPass& pass, double bound) {
  const std::size_t n = patch.size();
  const float gain = static_cast<float>(light.gain), bias = static_cast<float>(light.bias);
  if (light.gain_offset)
    residual_pass_offset(patch, gain, bias, light.gain_offset, b);
  else
    residual_pass(patch, gain, bias, b);
  const std::ptrdiff_t stride = patch.width;
  std::fill_n(b.weight.begin(), n, 0.0F);
  for (std::ptrdiff_t row = 1; row + 1 < patch.height; ++row) {
    const std::ptrdiff_t i = row * stride + 1;
    weight_row(b.clear.data() + i, patch.usable.data() + i, stride, stride - 2, b.weight.data() + i);
  }
  for (std::size_t i = 0; i < n; ++i) pass.points += static_cast<double>(b.weight[i]);
  const float noise = robust_noise(b, n);
  pass.noise_grey = static_cast<double>(noise);
  pass.weight = static_cast<double>(
      tukey_pass(b.residual.data(), b.weight.data(), n,
                 1.0F / (static_cast<float>(bound) * std::max(noise, static_cast<float>(kSmallestNoise)))));
}

AlignmentPass esm_pass(const Patch& patch, const Light& light, AlignmentBuffers& b, double bound) {
  AlignmentPass pass;
  pass.JtJ.setZero();
  pass.Jtr.setZero();
  weigh_points(patch, light, b, pass, bound);
  Block J;
  std::size_t filled = 0;
  const auto width = static_cast<std::size_t>(patch.width);
  for (int row = 1; row + 1 < patch.height; ++row) {
    for (std::size_t column = 1; column + 1 < width;) {
      const std::size_t count = std::min(width - 1 - column, kBlock - filled);
      const std::size_t i = static_cast<std::size_t>(row) * width + column;
      const RowInput in{b.grey.data() + i,
                        b.residual.data() + i,
                        b.weight.data() + i,
                        patch.gradient_x.data() + i,
                        patch.gradient_y.data() + i,
                        width,
                        patch.x_of(static_cast<int>(column)),
                        patch.step,
                        patch.y_of(row),
                        patch.template_share,
                        (1 - patch.template_share) * 0.5F * static_cast<float>(light.gain) / patch.step};
      jacobian_row(in, count, filled, J);
      filled += count;
      column += count;
      if (filled == kBlock) {
        accumulate(J, filled, pass);
        filled = 0;
      }
    }
  }
  if (filled > 0) accumulate(J, filled, pass);
  pass.JtJ.triangularView<Eigen::StrictlyLower>() = pass.JtJ.transpose();
  return pass;
}

namespace {

// Sums of one correlation.
struct Moments {
  double w = 0, a = 0, c = 0, aa = 0, cc = 0, ac = 0;
  void add(double weight, double x, double y) {
    w += weight;
    a += weight * x, c += weight * y;
    aa += weight * x * x, cc += weight * y * y, ac += weight * x * y;
  }
  double correlation() const {
    if (w <= 0) return 0;
    const double va = aa - a * a / w, vc = cc - c * c / w;
    return va > 0 && vc > 0 ? (ac - a * c / w) / std::sqrt(va * vc) : 0;
  }
};

}  // namespace

Correlation correlation(const Patch& patch, const Light& light, const AlignmentBuffers& b) {
  Moments believed, all;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    const double gain = light.gain + (light.gain_offset ? static_cast<double>(light.gain_offset[i]) : 0.0);
    const double x = gain * static_cast<double>(b.grey[i]), y = static_cast<double>(patch.grey[i]);
    believed.add(static_cast<double>(b.weight[i]), x, y);
    if (b.grey[i] < kSaturatedGrey) all.add(static_cast<double>(patch.usable[i] * b.inside[i]), x, y);
  }
  return {believed.correlation(), all.correlation()};
}

}  // namespace heartservo::tracking
