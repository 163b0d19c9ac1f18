#include "tracking/landmark/side_filter.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/random.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Eigen::Matrix3d tilted(double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d(0.6, 0.8, 0)).toRotationMatrix();
}
constexpr double kSigma = 0.05;
const SideFilter::Rotations kBoth{tilted(0.17), tilted(-0.17)}, kSwapped{kBoth[1], kBoth[0]};

TEST(SideFilter, OneFrameAloneIsJudgedByItsFit) {
  const SideFilter filter;
  const auto p = filter.log_probabilities(0, kBoth, {3, 5}, kSigma);
  EXPECT_DOUBLE_EQ(p[0], 0);
  EXPECT_DOUBLE_EQ(p[1], -1);
  EXPECT_EQ(filter.log_probabilities(0, kBoth, {3, kInfinity}, kSigma)[1], -kInfinity);
}

TEST(SideFilter, SmallEvidenceAddsUpAndIsBelievedAgainstOneFrame) {
  SideFilter filter;
  for (int k = 0; k < 10; ++k) filter.keep(k / 125.0, kBoth, {1, 2}, kSigma);
  const auto p = filter.log_probabilities(10 / 125.0, kBoth, {6, 0}, kSigma);
  EXPECT_GT(p[0], p[1]);
  // ten frames that say otherwise turn it
  for (int k = 10; k < 30; ++k) filter.keep(k / 125.0, kBoth, {6, 0}, kSigma);
  EXPECT_LT(filter.log_probabilities(30 / 125.0, kBoth, {1, 1}, kSigma)[0], -5);
}

TEST(SideFilter, SolutionsAreKnownByTheirRotationNotByTheirOrder) {
  SideFilter filter;
  for (int k = 0; k < 10; ++k)
    filter.keep(k / 125.0, k % 2 ? kSwapped : kBoth, k % 2 ? std::array{2.0, 1.0} : std::array{1.0, 2.0}, kSigma);
  const auto as_before = filter.log_probabilities(10 / 125.0, kBoth, {1, 1}, kSigma);
  EXPECT_GT(as_before[0], 4 + as_before[1]);
  const auto swapped = filter.log_probabilities(10 / 125.0, kSwapped, {1, 1}, kSigma);
  EXPECT_GT(swapped[1], 4 + swapped[0]);
}

TEST(SideFilter, AGapOrAnEarlierClockBeginsAnew) {
  SideFilter filter;
  for (int k = 0; k < 10; ++k) filter.keep(k / 125.0, kBoth, {1, 4}, kSigma);
  const double last = 9 / 125.0;
  EXPECT_LT(filter.log_probabilities(last + 0.24, kBoth, {2, 1}, kSigma)[1], 0);
  EXPECT_DOUBLE_EQ(filter.log_probabilities(last + 0.26, kBoth, {2, 1}, kSigma)[1], 0);
  EXPECT_DOUBLE_EQ(filter.keep(last - 0.03, kBoth, {2, 1}, kSigma)[1], 0);
}

TEST(SideFilter, FramesWithoutSolutionsChangeNothing) {
  SideFilter filter;
  for (int k = 0; k < 10; ++k) filter.keep(k / 125.0, kBoth, {1, 4}, kSigma);
  const auto before = filter.log_probabilities(0.1, kBoth, {2, 1}, kSigma);
  const auto none = filter.keep(0.08, kBoth, {kInfinity, kInfinity}, kSigma);
  EXPECT_EQ(none[0], -kInfinity);
  EXPECT_EQ(none[1], -kInfinity);
  EXPECT_EQ(filter.log_probabilities(0.1, kBoth, {2, 1}, kSigma), before);
}

TEST(SideFilter, WrongOptionsAreConfigurationErrors) {
  EXPECT_EQ((SideFilterOptions{0, 0, -1, 0, 1}.validate().size()), 5u);
  EXPECT_THROW(SideFilter({.motion_sigma = -1}), ConfigError);
}

}  // namespace
}  // namespace heartservo::tracking
