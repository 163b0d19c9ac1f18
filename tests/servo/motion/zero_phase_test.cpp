#include "servo/motion/zero_phase.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace heartservo::servo {
namespace {

constexpr double kTau = 2 * std::numbers::pi, kRate = 125;

std::vector<double> sine(double hz, std::size_t n, double phase = 0.3) {
  std::vector<double> series(n);
  for (std::size_t i = 0; i < n; ++i) series[i] = std::sin(kTau * hz * static_cast<double>(i) / kRate + phase);
  return series;
}

TEST(ZeroPhase, TheGainIsThatOfAButterworthFilterRunTwice) {
  const ZeroPhaseLowPass filter{2, 4};
  EXPECT_DOUBLE_EQ(filter.gain(0), 1);
  EXPECT_DOUBLE_EQ(filter.gain(2), 0.5);
  EXPECT_NEAR(filter.gain(4), 1 / (1 + std::pow(2, 8)), 1e-12);
}

// In the middle of a long series: a sine keeps its phase and gets the gain; its derivatives are exact.
TEST(ZeroPhase, SinesKeepTheirPhaseAndDerivativesAreExact) {
  constexpr std::size_t n = 1901;  // no length that transforms well
  for (const double hz : {0.5, 1.4, 2.2}) {
    const auto series = sine(hz, n);
    const ZeroPhaseLowPass filter{2, 10};
    const double w = kTau * hz, gain = filter.gain(hz);
    const auto value = low_pass(series, kRate, filter), first = low_pass(series, kRate, filter, 1),
               second = low_pass(series, kRate, filter, 2);
    for (std::size_t i = n / 3; i < 2 * n / 3; ++i) {
      const double turn = w * static_cast<double>(i) / kRate + 0.3;
      EXPECT_NEAR(value[i], gain * std::sin(turn), 2e-3) << hz;
      EXPECT_NEAR(first[i] / w, gain * std::cos(turn), 2e-3) << hz;
      EXPECT_NEAR(second[i] / (w * w), -gain * std::sin(turn), 2e-3) << hz;
    }
  }
}

TEST(ZeroPhase, ALinePassesUnchanged) {
  std::vector<double> series;
  for (int i = 0; i < 300; ++i) series.push_back(3 + 0.02 * i);
  const auto value = low_pass(series, kRate, {1}), slope = low_pass(series, kRate, {1}, 1);
  for (std::size_t i = 0; i < series.size(); ++i) {
    EXPECT_NEAR(value[i], series[i], 1e-9);
    EXPECT_NEAR(slope[i], 0.02 * kRate, 1e-9);
  }
  EXPECT_EQ(low_pass(std::vector<double>{1, 2}, kRate, {1}).size(), 2U);
}

TEST(ZeroPhase, TheAnalyticBandTurnsWithItsLine) {
  auto series = sine(1.2, 2500);
  const auto other = sine(4, 2500);
  for (std::size_t i = 0; i < series.size(); ++i) series[i] += other[i];
  const auto band = analytic_band(series, kRate, 0.7, 1.7);
  ASSERT_EQ(band.real.size(), series.size());
  for (std::size_t i = 800; i < 1700; ++i) {
    const double turn = kTau * 1.2 * static_cast<double>(i) / kRate + 0.3;
    EXPECT_NEAR(band.real[i], std::sin(turn), 5e-3);
    EXPECT_NEAR(band.imaginary[i], -std::cos(turn), 5e-3);
  }
}

}  // namespace
}  // namespace heartservo::servo
