#include "sim/sequence/picture_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::sim {

namespace {

constexpr int kSpan = 64;  // pixels at a time
constexpr double kSubpixels[4][2] = {{-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}};

using Vec4 = float __attribute__((vector_size(16)));

// (X, Y, Z) of a span's first sample and the step from pixel to pixel, both in texels, homogeneous.
struct Line {
  float X, Y, Z, dX, dY, dZ;
};

HEARTSERVO_SIMD void positions(const Line& line, float last_x, float last_y, int count, float* __restrict x,
                               float* __restrict y) {
  for (int i = 0; i < count; ++i) {
    const float k = static_cast<float>(i), w = 1 / (line.Z + k * line.dZ);
    const float px = std::fabs((line.X + k * line.dX) * w), py = std::fabs((line.Y + k * line.dY) * w);
    const float mx = last_x - std::fabs(last_x - px), my = last_y - std::fabs(last_y - py);
    x[i] = mx > 0 ? mx : 0;
    y[i] = my > 0 ? my : 0;
  }
}

// Catmull-Rom: weights of the samples at -1, 0, 1, 2 for a position f in 0 .. 1.
inline __attribute__((always_inline)) Vec4 weights(float f) {
  constexpr Vec4 a{0, 1, 0, 0}, b{-0.5F, 0, 0.5F, 0}, c{1, -2.5F, 2, -0.5F}, d{-0.5F, 1.5F, -1.5F, 0.5F};
  return a + f * (b + f * (c + f * d));
}

HEARTSERVO_SIMD void cubic(const float* texels, std::ptrdiff_t stride, const float* x, const float* y, int count,
                           float* __restrict sum) {
  for (int i = 0; i < count; ++i) {
    const int column = static_cast<int>(x[i]), row = static_cast<int>(y[i]);
    const float* from = texels + (row - 1) * stride + column - 1;
    Vec4 r0, r1, r2, r3;
    std::memcpy(&r0, from, sizeof r0);
    std::memcpy(&r1, from + stride, sizeof r1);
    std::memcpy(&r2, from + 2 * stride, sizeof r2);
    std::memcpy(&r3, from + 3 * stride, sizeof r3);
    const Vec4 wx = weights(x[i] - static_cast<float>(column)), wy = weights(y[i] - static_cast<float>(row));
    const Vec4 all = wx * (wy[0] * r0 + wy[1] * r1 + wy[2] * r2 + wy[3] * r3);
    sum[i] += 0.25F * (all[0] + all[1] + all[2] + all[3]);
  }
}

}  // namespace

PictureSampler::PictureSampler(const cv::Mat& grey, double texels_per_px, const Eigen::Vector2d& middle_px)
    : width_(grey.cols), height_(grey.rows) {
  CV_Assert(grey.type() == CV_32FC1 && grey.cols >= 8 && grey.rows >= 8);
  cv::copyMakeBorder(grey, padded_, kBorder, kBorder, kBorder, kBorder, cv::BORDER_REFLECT_101);
  A_texel_reference_ << texels_per_px, 0, 0.5 * (width_ - 1) - texels_per_px * middle_px.x(),  //
      0, texels_per_px, 0.5 * (height_ - 1) - texels_per_px * middle_px.y(),                   //
      0, 0, 1;
}

void PictureSampler::row(const Eigen::Matrix3d& H_reference_current, int u, int v, int count, float* grey) const {
  const Eigen::Matrix3d M = A_texel_reference_ * H_reference_current;
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(padded_.step1());
  const float* texels = padded_.ptr<float>(kBorder) + kBorder;
  float x[kSpan], y[kSpan];
  std::fill(grey, grey + count, 0.F);
  for (int done = 0; done < count; done += kSpan) {
    const int n = std::min(kSpan, count - done);
    for (const auto& offset : kSubpixels) {
      const Eigen::Vector3d p = M * Eigen::Vector3d(u + done + offset[0], v + offset[1], 1), step = M.col(0);
      const Eigen::Vector<float, 6> f = (Eigen::Vector<double, 6>() << p, step).finished().cast<float>();
      positions({f[0], f[1], f[2], f[3], f[4], f[5]}, static_cast<float>(width_ - 1), static_cast<float>(height_ - 1),
                n, x, y);
      cubic(texels, stride, x, y, n, grey + done);
    }
  }
}

}  // namespace heartservo::sim
