#include "sim/endoscope/tissue_texture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "sim/endoscope/painted_pattern.hpp"
#include "sim/endoscope/tissue_paint.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

/// Blur of the texture, m: half a pixel at 10.8 px per mm, about that of a good lens. Less than 0.1 % of the power is
/// left above what such a camera resolves.
constexpr double kBlur_m = 0.047e-3;

/// Covers the plate's square with its pattern, sharp edges smoothed by supersampling; matt and flat.
void paint_plate(const LandmarkOptions& landmark, std::uint32_t id, double texels_per_m, TissueLayers& layers,
                 cv::Mat& slope_a, cv::Mat& slope_b) {
  const int n = layers.grey.rows;
  const double half = landmark.side_m / 2, c = std::cos(landmark.angle_rad), s = std::sin(landmark.angle_rad);
  const double middle_i = landmark.x_m * texels_per_m + (n - 1) / 2.0,
               middle_j = landmark.y_m * texels_per_m + (n - 1) / 2.0;
  const double reach = half * 1.4143 * texels_per_m + 2;
  constexpr int kSamples = 3;
  for (int j = std::max(0, cvFloor(middle_j - reach)); j <= std::min(n - 1, cvCeil(middle_j + reach)); ++j)
    for (int i = std::max(0, cvFloor(middle_i - reach)); i <= std::min(n - 1, cvCeil(middle_i + reach)); ++i) {
      double grey = 0, covered = 0;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const double a = (i - middle_i + (k % kSamples + 0.5) / kSamples - 0.5) / texels_per_m;
        const double b = (j - middle_j + (k / kSamples + 0.5) / kSamples - 0.5) / texels_per_m;
        const double x = (c * a + s * b) / half, y = (c * b - s * a) / half;
        if (std::max(std::abs(x), std::abs(y)) > 1) continue;
        grey += painted_pattern(id, x, y), covered += 1;
      }
      if (covered == 0) continue;
      const float share = static_cast<float>(covered / (kSamples * kSamples));
      auto lay = [&](cv::Mat& plane, double value) {
        float& texel = plane.at<float>(j, i);
        texel += share * (static_cast<float>(value) - texel);
      };
      lay(layers.grey, grey / covered), lay(layers.gloss, 0), lay(slope_a, 0), lay(slope_b, 0);
    }
}

std::uint32_t packed_slope(float slope) {
  return static_cast<std::uint32_t>(std::clamp(cvRound(slope / TissueTexture::kSlopeStep) + 128, 0, 255));
}

}  // namespace

TissueTexture TissueTexture::procedural(const TextureOptions& options, const std::vector<LandmarkOptions>& landmarks,
                                        std::uint64_t seed) {
  const double texels_per_m = options.size / options.extent_m;
  TissueLayers layers = paint_tissue(options, seed);
  cv::Mat slope_a, slope_b;
  cv::Sobel(layers.height, slope_a, CV_32F, 1, 0, 3, texels_per_m / 8);
  cv::Sobel(layers.height, slope_b, CV_32F, 0, 1, 3, texels_per_m / 8);
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    paint_plate(landmarks[i], static_cast<std::uint32_t>(i), texels_per_m, layers, slope_a, slope_b);
  for (cv::Mat* plane : {&layers.grey, &layers.gloss, &slope_a, &slope_b})
    cv::GaussianBlur(*plane, *plane, {}, std::max(0.6, kBlur_m * texels_per_m));
  return from_planes(layers.grey, texels_per_m, slope_a, slope_b, layers.gloss);
}

TissueTexture TissueTexture::from_planes(const cv::Mat& grey, double texels_per_m, const cv::Mat& slope_a,
                                         const cv::Mat& slope_b, const cv::Mat& gloss) {
  for (const cv::Mat* plane : {&grey, &slope_a, &slope_b, &gloss})
    if ((plane == &grey || !plane->empty()) &&
        (plane->type() != CV_32FC1 || plane->rows != grey.rows || plane->cols != grey.rows || grey.rows < 8))
      throw ConfigError(fmt::format("texture: planes must be square, equal, CV_32FC1, 8 texels or more; got {} x {}",
                                    plane->cols, plane->rows));
  TissueTexture texture;
  texture.size_ = grey.rows;
  texture.texels_per_m_ = texels_per_m;
  texture.texels_.resize(static_cast<std::size_t>(grey.rows) * grey.rows);
  std::uint32_t* out = texture.texels_.data();
  for (int j = 0; j < grey.rows; ++j)
    for (int i = 0; i < grey.cols; ++i) {
      const auto level = static_cast<std::uint32_t>(std::clamp(cvRound(grey.at<float>(j, i) * 4), 0, 1023));
      const std::uint32_t a = packed_slope(slope_a.empty() ? 0 : slope_a.at<float>(j, i));
      const std::uint32_t b = packed_slope(slope_b.empty() ? 0 : slope_b.at<float>(j, i));
      const float shine = gloss.empty() ? 0 : gloss.at<float>(j, i);
      const auto g = static_cast<std::uint32_t>(std::clamp(cvRound(shine * 63), 0, 63));
      *out++ = level << 22 | a << 14 | b << 6 | g;
    }
  return texture;
}

}  // namespace heartservo::sim
