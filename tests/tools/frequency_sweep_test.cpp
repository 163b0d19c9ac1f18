#include "tools/frequency_sweep.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tracking/settings/errors.hpp"

namespace heartservo::tools {
namespace {

constexpr double kTau = 2 * M_PI;

// A textbook loop: L = k e^{-s D} / s. Phase -180 at w = pi / 2D, where |L| = 2 k D / pi; |L| = 1 at w = k.
TEST(FrequencySweep, MarginsOfADelayedIntegratorAreTheTextbooks) {
  const double k = 10, D = 0.04;
  std::vector<FrequencyPoint> points;
  for (const double hz : sweep_frequencies(0.3, 12, 60)) {
    const std::complex<double> s(0, kTau * hz), L = k * std::exp(-s * D) / s;
    points.push_back({hz, 1.0 / (1.0 + L), 0});
  }
  const Margins m = margins_of(points);
  EXPECT_NEAR(m.gain_at_hz, 1 / (4 * D), 0.05);
  EXPECT_NEAR(m.gain_db, -20 * std::log10(2 * k * D / M_PI), 0.1);
  EXPECT_NEAR(m.phase_at_hz, k / kTau, 0.02);
  EXPECT_NEAR(m.phase_deg, 90 - k * D * 180 / M_PI, 0.3);
  EXPECT_GT(m.worst_amplification, 1);
}

TEST(FrequencySweep, WithoutACrossingThereIsNoMargin) {
  const Margins m = margins_of({{1, {0.01, 0}, 1}, {2, {0.02, 0}, 2}});
  EXPECT_TRUE(std::isnan(m.gain_db));
  EXPECT_TRUE(std::isnan(m.phase_deg));
}

TEST(FrequencySweep, APointIsTheFirstHarmonicOfWhatIsLeft) {
  std::vector<double> t, goal, residual;
  for (int i = 0; i < 750; ++i) {
    t.push_back(0.008 * i);
    goal.push_back(0.055 + 0.002 * std::sin(kTau * 1.5 * t.back()));
    residual.push_back(t.back() < 2 ? 1 : -0.0004 * std::sin(kTau * 1.5 * t.back() + 0.7));
  }
  const FrequencyPoint p = point_of(1.5, t, goal, residual, 2);
  EXPECT_NEAR(std::abs(p.S), 0.2, 1e-6);
  EXPECT_NEAR(std::arg(p.S), 0.7, 1e-6);
  EXPECT_NEAR(p.left_percent, 20, 0.02) << "six whole periods";
}

TEST(FrequencySweep, ReadsItsRange) {
  EXPECT_EQ(parse_sweep("0.2:10"), (std::pair{0.2, 10.0}));
  for (const char* wrong : {"", "1", "1:", ":3", "a:3", "3:1", "1:2:3", "1:2x", "nan:3", "0:3", "1:100"})
    EXPECT_THROW(parse_sweep(wrong), ConfigError) << wrong;
}

}  // namespace
}  // namespace heartservo::tools
