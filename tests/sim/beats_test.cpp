#include "sim/heart/beats.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

TEST(CycleMarks, CoverTheDurationAndHaveTheStatedStatistics) {
  const auto marks = cycle_marks({1.19, 0.02, 0.3}, 4000, 17);
  EXPECT_LE(marks.front(), 0);
  EXPECT_GT(marks.back(), 4000);
  std::vector<double> period;
  for (std::size_t i = 1; i < marks.size(); ++i) period.push_back((marks[i] - marks[i - 1]) * 1.19 - 1);
  double mean = 0, power = 0, product = 0;
  for (const double p : period) mean += p / period.size();
  for (std::size_t i = 1; i < period.size(); ++i)
    power += std::pow(period[i] - mean, 2), product += (period[i] - mean) * (period[i - 1] - mean);
  EXPECT_NEAR(mean, 0, 0.002);
  EXPECT_NEAR(std::sqrt(power / period.size()), 0.02, 0.001);
  EXPECT_NEAR(product / power, 0.3, 0.05);
}

TEST(CycleMarks, DependOnTheSeedAlone) {
  EXPECT_EQ(cycle_marks({}, 60, 5), cycle_marks({}, 60, 5));
  EXPECT_NE(cycle_marks({}, 60, 5), cycle_marks({}, 60, 6));
}

TEST(PlausibleBeats, DropsWhatNoHeartWithThisSystoleCouldBeat) {
  EXPECT_EQ(plausible_beats({2.0, 0.0, 1.0, 1.2}), (std::vector<double>{0.0, 1.0, 2.0}));
}

TEST(PhaseClock, IsTheIdentityForNominalCycles) {
  const PhaseClock clock({0, 0.84, 1.68}, 0.84, kSystole_s);
  for (double t = 0; t < 1.679; t += 0.0137) EXPECT_NEAR(clock.phase(t), std::fmod(t / 0.84, 1), 1e-12);
  EXPECT_NEAR(clock.phase(-0.21), 0.75, 1e-12);
  EXPECT_NEAR(clock.phase(1.68 + 0.42), 0.5, 1e-12);
}

TEST(PhaseClock, KeepsSystoleAndStretchesDiastole) {
  const PhaseClock clock({0, 0.6, 1.7, 6.0}, 0.84, kSystole_s);
  for (const double mark : clock.marks())
    for (double since = 0; since < kSystole_s; since += 0.01)
      EXPECT_NEAR(clock.phase(mark + since), since / 0.84, 1e-9);
  double before = 0;
  for (double t = 0.7; t < 5.999; t += 0.001) {  // the pause of 4.3 s included
    if (clock.phase(t) < before) {
      EXPECT_NEAR(t, 1.7, 0.0011);
    }
    before = clock.phase(t);
  }
  EXPECT_NEAR(clock.phase(1.7 - 1e-9), 1, 1e-8);
  EXPECT_NEAR(clock.phase(6.0 - 1e-9), 1, 1e-8);
}

TEST(PhaseClock, HasAContinuousSecondDerivative) {
  const PhaseClock clock({0, 0.8, 1.7, 2.6}, 0.84, kSystole_s);
  const double h = 1e-4;
  double previous = 0, largest_step = 0, largest = 0;
  for (double t = 2 * h; t < 2.5; t += h) {
    double low = clock.phase(t - h), middle = clock.phase(t), high = clock.phase(t + h);
    middle += middle < low - 0.5, high += high < low - 0.5;
    const double second = (high - 2 * middle + low) / (h * h);
    largest_step = std::max(largest_step, std::abs(second - previous));
    largest = std::max(largest, std::abs(second));
    previous = second;
  }
  EXPECT_GT(largest, 0.2);  // it does bend
  EXPECT_LT(largest_step, 0.02 * largest);
}

TEST(PhaseClock, RefusesCyclesWithoutRoomForSystole) {
  EXPECT_THROW(PhaseClock({0, 0.3}, 0.84, kSystole_s), ConfigError);
  EXPECT_THROW(PhaseClock({0, 1}, 0.3, kSystole_s), ConfigError);
}

}  // namespace
}  // namespace heartservo::sim
