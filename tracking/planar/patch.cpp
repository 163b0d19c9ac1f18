#include "tracking/planar/patch.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tracking/planar/noise_of.hpp"
#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

namespace {

constexpr float kMuchNoise = 0.5F;  // of the texture's gradient, squared
constexpr double kSmoothing = 1.2;  // points

// Everything the inner loop needs, in floats: 3e-8 on the normalised plane is 2e-5 px.
struct WarpRow {
  float q0, q1, q2;     // G (x, y, 1) at the row's first point; of bent points G's last column
  float dq0, dq1, dq2;  // per column; of bent points G's first column
  float eq0, eq1, eq2;  // G's second column
  const float *bent_x, *bent_y;
  float fx, fy, cx, cy, k1, k2, k3, k4;
  float scale, u0, v0;
  const float* image;
  int stride;  // floats per row
  float border, u_max, v_max;
  int columns;
};

// Where column i of the row samples the level's picture, clamped into it by `border` pixels.
struct SamplePoint {
  float inside, a, b;  // a, b: fractions in [0, 1)
  int at;
};

template <bool kBent>
inline __attribute__((always_inline)) SamplePoint sample_point(const WarpRow& w, int i) {
  float x, y;
  if constexpr (kBent) {
    const float a = w.bent_x[i], b = w.bent_y[i];
    const float inverse = 1.0F / (w.q2 + a * w.dq2 + b * w.eq2);
    x = (w.q0 + a * w.dq0 + b * w.eq0) * inverse, y = (w.q1 + a * w.dq1 + b * w.eq1) * inverse;
  } else {
    const float t = static_cast<float>(i);
    const float inverse = 1.0F / (w.q2 + t * w.dq2);
    x = (w.q0 + t * w.dq0) * inverse, y = (w.q1 + t * w.dq1) * inverse;
  }
  const float r2 = x * x + y * y, xy2 = 2 * x * y;
  const float radial = 1 + r2 * (w.k1 + r2 * w.k2);  // eq. 3
  const float xd = x * radial + w.k3 * xy2 + w.k4 * (r2 + 2 * x * x);
  const float yd = y * radial + w.k3 * (r2 + 2 * y * y) + w.k4 * xy2;
  const float u = (w.fx * xd + w.cx) * w.scale - w.u0;
  const float v = (w.fy * yd + w.cy) * w.scale - w.v0;
  // in this order a NaN becomes the border, inside the picture, and then compares unequal
  const float uc = std::min(std::max(w.border, u), w.u_max), vc = std::min(std::max(w.border, v), w.v_max);
  const int iu = static_cast<int>(uc), iv = static_cast<int>(vc);
  return {(uc == u) & (vc == v) ? 1.0F : 0.0F, uc - static_cast<float>(iu), vc - static_cast<float>(iv),
          iv * w.stride + iu};
}

template <bool kBent>
inline __attribute__((always_inline)) void linear_row(const WarpRow& w, float* __restrict grey,
                                                      float* __restrict inside) {
#pragma omp simd
  for (int i = 0; i < w.columns; ++i) {
    const SamplePoint s = sample_point<kBent>(w, i);
    const float* p = w.image + s.at;
    const float top = p[0] + s.a * (p[1] - p[0]);
    const float bottom = p[w.stride] + s.a * (p[w.stride + 1] - p[w.stride]);
    grey[i] = top + s.b * (bottom - top);
    inside[i] = s.inside;
  }
}

// Catmull-Rom: keeps the contrast between pixels, which bilinear sampling lowers by up to w^2/8 at angular frequency w.
inline __attribute__((always_inline)) float cubic(float a, float p0, float p1, float p2, float p3) {
  return p1 + 0.5F * a * (p2 - p0 + a * (2 * p0 - 5 * p1 + 4 * p2 - p3 + a * (3 * (p1 - p2) + p3 - p0)));
}

template <bool kBent>
inline __attribute__((always_inline)) void cubic_row(const WarpRow& w, float* __restrict grey,
                                                     float* __restrict inside) {
#pragma omp simd
  for (int i = 0; i < w.columns; ++i) {
    const SamplePoint s = sample_point<kBent>(w, i);
    const float* p = w.image + s.at;
    const int n = w.stride;
    grey[i] = cubic(s.b, cubic(s.a, p[-n - 1], p[-n], p[1 - n], p[2 - n]), cubic(s.a, p[-1], p[0], p[1], p[2]),
                    cubic(s.a, p[n - 1], p[n], p[n + 1], p[n + 2]),
                    cubic(s.a, p[2 * n - 1], p[2 * n], p[2 * n + 1], p[2 * n + 2]));
    inside[i] = s.inside;
  }
}

using RowFunction = void(const WarpRow& w, float* __restrict grey, float* __restrict inside);
HEARTSERVO_SIMD void warp_row_linear(const WarpRow& w, float* __restrict grey, float* __restrict inside) {
  linear_row<false>(w, grey, inside);
}
HEARTSERVO_SIMD void warp_row_cubic(const WarpRow& w, float* __restrict grey, float* __restrict inside) {
  cubic_row<false>(w, grey, inside);
}
HEARTSERVO_SIMD void warp_bent_row_linear(const WarpRow& w, float* __restrict grey, float* __restrict inside) {
  linear_row<true>(w, grey, inside);
}
HEARTSERVO_SIMD void warp_bent_row_cubic(const WarpRow& w, float* __restrict grey, float* __restrict inside) {
  cubic_row<true>(w, grey, inside);
}

}  // namespace

void warp(const PyramidLevel& level, const Camera& camera, const Eigen::Matrix3d& G_plane_patch, const Patch& patch,
          Interpolation interpolation, float* grey, float* inside, const BentPoints& bent) {
  WarpRow w{};
  w.fx = static_cast<float>(camera.fx), w.fy = static_cast<float>(camera.fy);
  w.cx = static_cast<float>(camera.cx), w.cy = static_cast<float>(camera.cy);
  w.k1 = static_cast<float>(camera.k1), w.k2 = static_cast<float>(camera.k2);
  w.k3 = static_cast<float>(camera.k3), w.k4 = static_cast<float>(camera.k4);
  w.scale = level.scale, w.u0 = level.u0, w.v0 = level.v0;
  w.image = level.image.ptr<float>();
  w.stride = static_cast<int>(level.image.step1());
  const bool is_cubic = interpolation == Interpolation::CUBIC;
  w.border = is_cubic ? 1 : 0;  // the neighbours stay in the picture
  w.u_max = static_cast<float>(level.image.cols) - 1.001F - w.border;
  w.v_max = static_cast<float>(level.image.rows) - 1.001F - w.border;
  w.columns = patch.width;
  const bool is_bent = bent.x != nullptr;
  const Eigen::Vector3f G_x = G_plane_patch.col(0).cast<float>() * (is_bent ? 1 : patch.step);
  const Eigen::Vector3f G_y = G_plane_patch.col(1).cast<float>();
  w.dq0 = G_x.x(), w.dq1 = G_x.y(), w.dq2 = G_x.z();
  w.eq0 = G_y.x(), w.eq1 = G_y.y(), w.eq2 = G_y.z();
  RowFunction* const rows[2][2] = {{warp_row_linear, warp_row_cubic}, {warp_bent_row_linear, warp_bent_row_cubic}};
  RowFunction* const warp_row = rows[is_bent][is_cubic];
  for (int row = 0; row < patch.height; ++row) {
    const int first = row * patch.width;
    const Eigen::Vector3d start =
        is_bent ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(patch.x_of(0), patch.y_of(row), 1);
    const Eigen::Vector3f q = (G_plane_patch * start).cast<float>();
    w.q0 = q.x(), w.q1 = q.y(), w.q2 = q.z();
    if (is_bent) w.bent_x = bent.x + first, w.bent_y = bent.y + first;
    warp_row(w, grey + first, inside + first);
  }
}

namespace {

void differentiate(const std::vector<float>& grey, Patch& patch) {
  const float half = 0.5F / patch.step;
  const auto w = static_cast<std::size_t>(patch.width);
  for (int row = 1; row + 1 < patch.height; ++row)
    for (int column = 1; column + 1 < patch.width; ++column) {
      const auto i = static_cast<std::size_t>(row * patch.width + column);
      patch.gradient_x[i] = half * (grey[i + 1] - grey[i - 1]);
      patch.gradient_y[i] = half * (grey[i + w] - grey[i - w]);
    }
}

}  // namespace

Patch make_patch(const PyramidLevel& level, const Camera& camera, const Eigen::Matrix3d& G_plane_patch, int width,
                 int height) {
  Patch patch;
  patch.width = width;
  patch.height = height;
  patch.step = 2.0F / static_cast<float>(std::max(width, height) - 1);
  const auto n = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  patch.grey.resize(n);
  patch.gradient_x.assign(n, 0);
  patch.gradient_y.assign(n, 0);
  patch.usable.assign(n, 0);
  std::vector<float> inside(n);
  warp(level, camera, G_plane_patch, patch, Interpolation::CUBIC, patch.grey.data(), inside.data());
  differentiate(patch.grey, patch);
  for (int row = 1; row + 1 < height; ++row)
    for (int column = 1; column + 1 < width; ++column) {
      const auto i = static_cast<std::size_t>(row * width + column);
      patch.usable[i] = inside[i];
    }
  // Glare spoils the gradients and the blurred rim around it too.
  constexpr int kRim = 2;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      if (patch.grey[static_cast<std::size_t>(row * width + column)] < kSaturatedGrey) continue;
      for (int v = std::max(0, row - kRim); v <= std::min(height - 1, row + kRim); ++v)
        for (int u = std::max(0, column - kRim); u <= std::min(width - 1, column + kRim); ++u)
          patch.usable[static_cast<std::size_t>(v * width + u)] = 0;
    }
  return patch;
}

void quieten_gradient(Patch& patch) {
  const float noise = static_cast<float>(noise_of(patch)) / std::sqrt(2.0F) / patch.step;
  patch.gradient_noise = noise;
  Eigen::Matrix2f sum = Eigen::Matrix2f::Zero();
  float n = 0;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    const Eigen::Vector2f g(patch.gradient_x[i], patch.gradient_y[i]);
    sum += patch.usable[i] * g * g.transpose();
    n += patch.usable[i];
  }
  if (!(n > 0)) return;
  // the smaller eigenvalue: the texture in its weakest direction, with noise
  const float mean = sum.trace() / 2, weakest = (mean - std::sqrt(std::max(0.0F, mean * mean - sum.determinant()))) / n;
  if (noise * noise < kMuchNoise * (weakest - noise * noise)) return;
  const cv::Size size(patch.width, patch.height);
  cv::Mat smooth(size, CV_32FC1), clear(size, CV_32FC1);
  for (std::size_t i = 0; i < patch.size(); ++i) {
    clear.ptr<float>()[i] = patch.grey[i] < kSaturatedGrey ? 1 : 0;
    smooth.ptr<float>()[i] = clear.ptr<float>()[i] * patch.grey[i];
  }
  cv::GaussianBlur(smooth, smooth, {}, kSmoothing);
  cv::GaussianBlur(clear, clear, {}, kSmoothing);
  std::vector<float> grey(patch.size());
  for (std::size_t i = 0; i < patch.size(); ++i)
    grey[i] = smooth.ptr<float>()[i] / std::max(1e-3F, clear.ptr<float>()[i]);
  differentiate(grey, patch);
  patch.template_share = 1;
  // of the derivative of a Gaussian: sigma^2 / (8 pi s^4)
  patch.gradient_noise = noise * std::sqrt(2.0F / (8 * static_cast<float>(M_PI * std::pow(kSmoothing, 4))));
}

}  // namespace heartservo::tracking
