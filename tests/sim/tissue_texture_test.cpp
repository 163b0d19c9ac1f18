#include "sim/endoscope/tissue_texture.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/endoscope/painted_pattern.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

TextureOptions small() {
  TextureOptions options;
  options.size = 512, options.extent_m = 0.02;
  return options;
}

double grey_at(const TissueTexture& texture, int j, int i) {
  return (texture.texels()[j * texture.size() + i] >> 22) / 4.0;
}

TEST(TissueTexture, DependsOnTheSeedAlone) {
  const auto a = TissueTexture::procedural(small(), {}, 1), b = TissueTexture::procedural(small(), {}, 1),
             c = TissueTexture::procedural(small(), {}, 2);
  const std::size_t n = 512 * 512;
  EXPECT_TRUE(std::equal(a.texels(), a.texels() + n, b.texels()));
  EXPECT_FALSE(std::equal(a.texels(), a.texels() + n, c.texels()));
}

TEST(TissueTexture, IsTooSmoothToAlias) {
  // Along rows: the power above half the camera's sampling rate at 10.8 px per mm (5.4 cycles per mm) against all of
  // it.
  const auto texture = TissueTexture::procedural(small(), {}, 3);
  double high = 0, all = 0;
  for (int j = 0; j < 512; j += 37)
    for (int k = 1; k < 256; ++k) {
      double c = 0, s = 0;
      for (int i = 0; i < 512; ++i) {
        const double value = grey_at(texture, j, i) * (1 - std::cos(2 * M_PI * i / 512));
        c += value * std::cos(2 * M_PI * k * i / 512), s += value * std::sin(2 * M_PI * k * i / 512);
      }
      if (k > 2) all += c * c + s * s;
      if (k > 5.4 * 20) high += c * c + s * s;
    }
  EXPECT_LT(high, 0.001 * all);
}

TEST(TissueTexture, HasTheLandmarkWhereItIsGlued) {
  LandmarkOptions landmark;
  landmark.x_m = 0.002, landmark.y_m = -0.001, landmark.angle_rad = 0.5;
  const auto texture = TissueTexture::procedural(small(), {landmark}, 1),
             bare = TissueTexture::procedural(small(), {}, 1);
  for (const double y : {-0.7, -0.1, 0.5})
    for (const double x : {-0.6, 0.0, 0.7}) {
      const double p = x * 0.0025, q = y * 0.0025, c = std::cos(0.5), s = std::sin(0.5);
      const int i = static_cast<int>(std::lround((0.002 + c * p - s * q) * 25600 + 255.5));
      const int j = static_cast<int>(std::lround((-0.001 + s * p + c * q) * 25600 + 255.5));
      double expected = 0;  // the pattern, blurred as the texture is
      for (int k = -3; k <= 3; ++k)
        for (int l = -3; l <= 3; ++l) expected += painted_pattern(0, x + k * 0.0156, y + l * 0.0156) / 49;
      EXPECT_NEAR(grey_at(texture, j, i), expected, 22);
      EXPECT_EQ(texture.texels()[j * 512 + i] & 63, 0u) << "plates are matt";
    }
  EXPECT_EQ(texture.texels()[20 * 512 + 20], bare.texels()[20 * 512 + 20]);
}

TEST(PaintedPattern, HasStrongGradientsBothWaysAndNoSymmetryInsideItsFrame) {
  for (const std::uint32_t id : {0u, 1u, 1000u}) {
    double gx = 0, gy = 0, variance = 0, mirrored = 0, turned = 0, mean = 0;
    int n = 0;
    for (double y = -0.66; y <= 0.66; y += 0.02)
      for (double x = -0.66; x <= 0.66; x += 0.02) mean += painted_pattern(id, x, y), ++n;
    mean /= n;
    for (double y = -0.66; y <= 0.66; y += 0.02)
      for (double x = -0.66; x <= 0.66; x += 0.02) {
        const double g = painted_pattern(id, x, y) - mean;
        gx += std::pow(painted_pattern(id, x + 0.02, y) - mean - g, 2) / n;
        gy += std::pow(painted_pattern(id, x, y + 0.02) - mean - g, 2) / n;
        variance += g * g / n;
        mirrored += g * (painted_pattern(id, -x, y) - mean) / n, turned += g * (painted_pattern(id, -y, x) - mean) / n;
      }
    EXPECT_GT(std::sqrt(variance), 35) << id;
    EXPECT_GT(std::sqrt(gx), 7) << id;  // grey levels per half pixel of a 54 px landmark
    EXPECT_GT(std::sqrt(gy), 7) << id;
    EXPECT_LT(std::abs(mirrored), 0.4 * variance) << id;
    EXPECT_LT(std::abs(turned), 0.4 * variance) << id;
  }
}

TEST(TissueTexture, RefusesPlanesOfOtherSizesOrTypes) {
  const cv::Mat grey(64, 64, CV_32FC1, cv::Scalar(100));
  EXPECT_EQ(TissueTexture::from_planes(grey, 1000).size(), 64);
  EXPECT_THROW(TissueTexture::from_planes(cv::Mat(64, 32, CV_32FC1), 1000), ConfigError);
  EXPECT_THROW(TissueTexture::from_planes(cv::Mat(64, 64, CV_8UC1), 1000), ConfigError);
  EXPECT_THROW(TissueTexture::from_planes(grey, 1000, cv::Mat(32, 32, CV_32FC1)), ConfigError);
}

}  // namespace
}  // namespace heartservo::sim
