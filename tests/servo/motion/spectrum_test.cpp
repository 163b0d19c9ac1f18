#include "servo/motion/spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace heartservo::servo {
namespace {

constexpr double kRate = 100;

TEST(Welch, ALinesPowerIsHalfItsSquaredAmplitude) {
  std::vector<double> series;
  for (int i = 0; i < 3000; ++i) series.push_back(5 + 3 * std::cos(2 * std::numbers::pi * 1.23 * i / kRate));
  for (const double segment_s : {10.0, 12.34, 30.0, 1e6}) {
    const auto spectrum = welch(series, kRate, segment_s);
    EXPECT_NEAR(spectrum.power(1.23 - 0.4, 1.23 + 0.4), 4.5, 0.01) << segment_s;
    EXPECT_NEAR(spectrum.power(3, 50), 0, 1e-4) << segment_s;
    EXPECT_LE(spectrum.segment_s, 30.0);
  }
  EXPECT_EQ(welch(series, kRate, 10).segments, 5);
}

TEST(Welch, WhiteNoiseIsFlatAndHasItsVariance) {
  std::mt19937_64 random(20251124);
  std::normal_distribution<double> normal(0, 2);
  std::vector<double> series(40000);
  for (double& v : series) v = normal(random);
  const auto spectrum = welch(series, kRate, 8);
  EXPECT_NEAR(spectrum.power(0, INFINITY), 4, 0.15);
  EXPECT_NEAR(noise_density(spectrum), 4 / (kRate / 2), 0.003);
  EXPECT_NEAR(spectrum.power(10, 20), 0.8, 0.05);
}

TEST(Welch, PowerSharesValuesBetweenBands) {
  const Spectrum spectrum{0.5, 2, 1, {1, 1, 1, 1, 1}};
  EXPECT_DOUBLE_EQ(spectrum.power(0.5, 1.1) + spectrum.power(1.1, 1.5), 1);
  EXPECT_DOUBLE_EQ(spectrum.power(0.6, 0.7), 0.1);
}

}  // namespace
}  // namespace heartservo::servo
