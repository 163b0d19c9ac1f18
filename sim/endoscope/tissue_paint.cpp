#include "sim/endoscope/tissue_paint.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace heartservo::sim {
namespace {

float step(float low, float high, float x) {
  const float f = std::clamp((x - low) / (high - low), 0.f, 1.f);
  return f * f * (3 - 2 * f);
}

/// Muscle fibres: noise stretched along a direction that wanders a little over the heart.
cv::Mat fibres(const TextureOptions& options, double length, double width, cv::RNG& random) {
  const int n = options.size;
  const cv::Mat wander = smooth_noise(n, n / 5.0, random);
  cv::Mat noise(512, 512, CV_32FC1), x(n, n, CV_32FC1), y(n, n, CV_32FC1), grain;
  random.fill(noise, cv::RNG::NORMAL, 0, 1);
  const double c = std::cos(options.fibre_angle_rad), s = std::sin(options.fibre_angle_rad), bend = 0.035 * n;
  for (int j = 0; j < n; ++j) {
    const float* w = wander.ptr<float>(j);
    float *px = x.ptr<float>(j), *py = y.ptr<float>(j);
    for (int i = 0; i < n; ++i) {
      px[i] = static_cast<float>((c * i + s * j) / length + n);
      py[i] = static_cast<float>((c * j - s * i + bend * w[i]) / width + n);
    }
  }
  cv::remap(noise, grain, x, y, cv::INTER_LINEAR, cv::BORDER_WRAP);
  return grain;
}

}  // namespace

cv::Mat smooth_noise(int size, double wavelength, cv::RNG& random) {
  // White noise, four samples to a wavelength, blurred and enlarged. Not by cv::warpAffine: it rounds positions to 1/32
  // of a sample, which shows as a grid in the slopes.
  constexpr double kBlur = 1.2;
  const int coarse = std::max(8, cvCeil(4 * size / wavelength));
  cv::Mat noise(coarse, coarse, CV_32FC1), fine;
  random.fill(noise, cv::RNG::NORMAL, 0, 2 * kBlur * std::sqrt(CV_PI));
  cv::GaussianBlur(noise, noise, {}, kBlur, kBlur, cv::BORDER_REFLECT);
  cv::resize(noise, fine, {size, size}, 0, 0, cv::INTER_CUBIC);
  return fine;
}

TissueLayers paint_tissue(const TextureOptions& options, std::uint64_t seed) {
  const int n = options.size;
  const double mm = n / options.extent_m * 1e-3;  // texels per mm
  cv::RNG random(seed ^ 0x7e77u);
  const cv::Mat fine_grain = fibres(options, 1.6 * mm, 0.11 * mm, random);
  const cv::Mat coarse_grain = fibres(options, 5 * mm, 0.45 * mm, random);
  const cv::Mat tone = smooth_noise(n, 9 * mm, random), blotch = smooth_noise(n, 2.4 * mm, random);
  const cv::Mat fat_field = smooth_noise(n, 16 * mm, random), fat_edge = smooth_noise(n, 3 * mm, random);
  const cv::Mat lobules = smooth_noise(n, 0.9 * mm, random), bumps = smooth_noise(n, 4.5 * mm, random);
  const cv::Mat ripples = smooth_noise(n, 1.8 * mm, random);
  const cv::Mat vessels = paint_vessels(n, 1e3 * mm, options.vessels, random);
  cv::Mat speckle(n, n, CV_32FC1), walls;
  random.fill(speckle, cv::RNG::UNIFORM, -1, 1);
  cv::GaussianBlur(vessels, walls, {}, 0.22 * mm);

  TissueLayers layers{cv::Mat(n, n, CV_32FC1), cv::Mat(n, n, CV_32FC1), cv::Mat(n, n, CV_32FC1),
                      cv::Mat(n, n, CV_32FC1), vessels};
  const float fat_from = static_cast<float>(1.4 - 0.75 * options.fat), contrast = static_cast<float>(options.contrast);
  const float relief = static_cast<float>(options.relief * 1e-6);
  for (int j = 0; j < n; ++j) {
    const float *g1 = fine_grain.ptr<float>(j), *g2 = coarse_grain.ptr<float>(j), *t = tone.ptr<float>(j);
    const float *bl = blotch.ptr<float>(j), *ff = fat_field.ptr<float>(j), *fe = fat_edge.ptr<float>(j);
    const float *lo = lobules.ptr<float>(j), *bu = bumps.ptr<float>(j), *ri = ripples.ptr<float>(j);
    const float *ve = vessels.ptr<float>(j), *wa = walls.ptr<float>(j), *sp = speckle.ptr<float>(j);
    float* fat_share = layers.fat.ptr<float>(j);
    float *grey = layers.grey.ptr<float>(j), *height = layers.height.ptr<float>(j), *gloss = layers.gloss.ptr<float>(j);
    for (int i = 0; i < n; ++i) {
      // Fat lies where a slow field is high, and along the larger vessels.
      const float fat = options.fat > 0 ? step(fat_from, fat_from + 0.5f, ff[i] + 0.35f * fe[i] + 0.9f * wa[i]) : 0;
      const float muscle = 11 * g1[i] + 9 * g2[i] + 9 * t[i] + 7 * bl[i];
      const float fatty = 58 + 9 * lo[i] + 6 * bl[i];
      const float tissue = 112 + contrast * (muscle + fat * (fatty - muscle) + 7 * sp[i] * (1 - 0.5f * fat));
      const float blood = 112 + contrast * (-58 + 30 * fat * (1 - ve[i]) + 3 * bl[i]);
      grey[i] = std::clamp(tissue + 0.9f * ve[i] * (blood - tissue), 4.f, 250.f);
      height[i] = relief * (520 * bu[i] + 5 * lo[i] + 60 * ri[i] + 3 * g2[i] + 150 * wa[i]);
      gloss[i] = 0.9f - 0.35f * fat;
      fat_share[i] = fat;
    }
  }
  // A wet film rounds the finest edges.
  cv::GaussianBlur(layers.height, layers.height, {}, 0.1 * mm);
  return layers;
}

}  // namespace heartservo::sim
