#include "servo/safety/command_guard.hpp"

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace heartservo::servo {
namespace {

constexpr double kPeriod = 0.008;

TEST(CommandGuard, LeavesAHarmlessCommandAlone) {
  CommandGuard guard(GuardOptions{});
  const Eigen::Vector3d v(0.02, -0.03, 0.01);
  const GuardReport report = guard.check(v, Eigen::Vector3d::Zero(), kPeriod);
  EXPECT_EQ(report.velocity, v);
  EXPECT_FALSE(report.limited() || report.not_finite);
  EXPECT_TRUE(report.stop.empty());
}

TEST(CommandGuard, HoldsEveryLimitOnRandomCommands) {
  auto random = test::seeded();
  GuardOptions options;
  options.max_speed = 0.2;
  options.max_acceleration = 4;
  options.max_step_m = 0.001;
  CommandGuard guard(options);
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  int limited = 0;
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3d wanted(test::normal(random, 0.3), test::normal(random, 0.3), test::normal(random, 0.3));
    const GuardReport report = guard.check(wanted, Eigen::Vector3d::Zero(), kPeriod);
    EXPECT_LE(report.velocity.norm(), options.max_speed + 1e-12);
    EXPECT_LE(report.velocity.norm() * kPeriod, options.max_step_m + 1e-12);
    EXPECT_LE((report.velocity - last).norm(), options.max_acceleration * kPeriod + 1e-9);
    limited += report.limited();
    last = report.velocity;
  }
  EXPECT_GT(limited, 1000);
}

TEST(CommandGuard, NotFiniteBecomesZeroAndThenAStop) {
  GuardOptions options;
  options.bad_commands_to_stop = 3;
  CommandGuard guard(options);
  const Eigen::Vector3d nan(0, NAN, 0);
  EXPECT_TRUE(guard.check(nan, Eigen::Vector3d::Zero(), kPeriod).velocity.isZero());
  EXPECT_TRUE(guard.check(nan, Eigen::Vector3d::Zero(), kPeriod).stop.empty());
  EXPECT_TRUE(guard.check(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), kPeriod).stop.empty());  // counts in a row
  guard.check(nan, Eigen::Vector3d::Zero(), kPeriod);
  guard.check(nan, Eigen::Vector3d::Zero(), kPeriod);
  const GuardReport report = guard.check(nan, Eigen::Vector3d::Zero(), kPeriod);
  EXPECT_NE(report.stop.find("not finite"), std::string::npos);
  EXPECT_TRUE(report.velocity.isZero());
}

TEST(CommandGuard, LeavingTheWorkspaceStops) {
  GuardOptions options;
  options.workspace_radius_m = 0.01;
  CommandGuard guard(options);
  EXPECT_TRUE(guard.check(Eigen::Vector3d::Zero(), {0.1, 0, 0}, kPeriod).stop.empty());
  EXPECT_TRUE(guard.check(Eigen::Vector3d::Zero(), {0.109, 0, 0}, kPeriod).stop.empty());
  EXPECT_NE(guard.check(Eigen::Vector3d::Zero(), {0.111, 0, 0}, kPeriod).stop.find("workspace"), std::string::npos);
}

TEST(CommandGuard, AcceptsItsDefaultsAndRefusesAStepBeyondTheWorkspace) {
  EXPECT_TRUE(GuardOptions{}.validate().empty());
  GuardOptions options;
  options.max_step_m = 1;
  EXPECT_EQ(options.validate().size(), 1U);
}

}  // namespace
}  // namespace heartservo::servo
