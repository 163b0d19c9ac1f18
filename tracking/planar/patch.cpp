#include "tracking/planar/patch.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tracking/planar/noise_of.hpp"
#include "tracking/planar/simd/warp_kernel.hpp"

namespace heartservo::tracking {

namespace {

constexpr float kMuchNoise = 0.5F;  // of the texture's gradient, squared
constexpr double kSmoothing = 1.2;  // points

}  // namespace

void warp(const PyramidLevel& level, const Camera& camera, const Eigen::Matrix3d& G_plane_patch, const Patch& patch,
          Interpolation interpolation, float* grey, float* inside, const BentPoints& bent) {
  simd::WarpJob job{};
  const double scale = static_cast<double>(level.scale);
  const double u_add = camera.cx * scale - static_cast<double>(level.u0),
               v_add = camera.cy * scale - static_cast<double>(level.v0);
  Eigen::Matrix3d G = G_plane_patch;
  job.k1 = static_cast<float>(camera.k1), job.k2 = static_cast<float>(camera.k2);
  job.k3 = static_cast<float>(camera.k3), job.k4 = static_cast<float>(camera.k4);
  job.lens = camera.k1 != 0 || camera.k2 != 0 || camera.k3 != 0 || camera.k4 != 0;
  job.u_scale = static_cast<float>(camera.fx * scale), job.u_add = static_cast<float>(u_add);
  job.v_scale = static_cast<float>(camera.fy * scale), job.v_add = static_cast<float>(v_add);
  if (!job.lens) {  // straight to the level's pixels
    Eigen::Matrix3d K;
    K << camera.fx * scale, 0, u_add, 0, camera.fy * scale, v_add, 0, 0, 1;
    G = K * G_plane_patch;
  }
  for (int i = 0; i < 3; ++i) {
    job.per_x[i] = static_cast<float>(G(i, 0)), job.per_y[i] = static_cast<float>(G(i, 1));
    job.origin[i] = static_cast<float>(G(i, 2));
  }
  if (level.bytes.empty()) {
    job.image = level.image.ptr<float>();
    job.stride = static_cast<std::ptrdiff_t>(level.image.step1());
  } else {
    job.bytes = level.bytes.ptr();
    job.stride = static_cast<std::ptrdiff_t>(level.bytes.step1());
  }
  job.cubic = interpolation == Interpolation::CUBIC;
  job.border = job.cubic ? 1 : 0;  // the neighbours stay in the picture
  job.u_max = static_cast<float>(level.cols()) - 1.001F - job.border;
  job.v_max = static_cast<float>(level.rows()) - 1.001F - job.border;
  job.columns = patch.width, job.rows = patch.height;
  job.first_x = patch.x_of(0), job.first_y = patch.y_of(0), job.step = patch.step;
  job.bent_x = bent.x, job.bent_y = bent.y;
  simd::warp_grid(job, grey, inside);
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
  std::vector<float> scratch;
  make_patch(level, camera, G_plane_patch, width, height, patch, scratch);
  return patch;
}

void make_patch(const PyramidLevel& level, const Camera& camera, const Eigen::Matrix3d& G_plane_patch, int width,
                int height, Patch& patch, std::vector<float>& scratch) {
  patch.template_share = Patch().template_share;
  patch.gradient_noise = 0;
  patch.width = width;
  patch.height = height;
  patch.step = 2.0F / static_cast<float>(std::max(width, height) - 1);
  const auto n = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  patch.grey.resize(n);
  patch.gradient_x.assign(n, 0);
  patch.gradient_y.assign(n, 0);
  patch.usable.assign(n, 0);
  scratch.resize(std::max(scratch.size(), n));
  const float* inside = scratch.data();
  warp(level, camera, G_plane_patch, patch, Interpolation::CUBIC, patch.grey.data(), scratch.data());
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
