#include "servo/safety/command_guard.hpp"

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace heartservo::servo {
namespace {

constexpr double kPeriod = 0.008;

GuardView at(const Eigen::Vector3d& tip) {
  GuardView view;
  view.tip = tip;
  return view;
}

TEST(CommandGuard, LeavesAHarmlessCommandAlone) {
  CommandGuard guard(GuardOptions{});
  const Eigen::Vector3d v(0.02, -0.03, 0.01);
  const GuardReport report = guard.check(v, GuardView{}, kPeriod);
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
    const GuardReport report = guard.check(wanted, GuardView{}, kPeriod);
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
  EXPECT_TRUE(guard.check(nan, GuardView{}, kPeriod).velocity.isZero());
  EXPECT_TRUE(guard.check(nan, GuardView{}, kPeriod).stop.empty());
  EXPECT_TRUE(guard.check(Eigen::Vector3d::Zero(), GuardView{}, kPeriod).stop.empty());  // counts in a row
  guard.check(nan, GuardView{}, kPeriod);
  guard.check(nan, GuardView{}, kPeriod);
  const GuardReport report = guard.check(nan, GuardView{}, kPeriod);
  EXPECT_NE(report.stop.find("not finite"), std::string::npos);
  EXPECT_TRUE(report.velocity.isZero());
}

TEST(CommandGuard, LeavingTheWorkspaceStops) {
  GuardOptions options;
  options.workspace_radius_m = 0.01;
  CommandGuard guard(options);
  EXPECT_TRUE(guard.check(Eigen::Vector3d::Zero(), at({0.1, 0, 0}), kPeriod).stop.empty());
  EXPECT_TRUE(guard.check(Eigen::Vector3d::Zero(), at({0.109, 0, 0}), kPeriod).stop.empty());
  EXPECT_NE(guard.check(Eigen::Vector3d::Zero(), at({0.111, 0, 0}), kPeriod).stop.find("workspace"), std::string::npos);
}

TEST(CommandGuard, NotFiniteBrakesNoHarderThanAllowed) {
  GuardOptions options;
  options.max_acceleration = 5;
  CommandGuard guard(options);
  for (int k = 0; k < 10; ++k) guard.check({0.1, 0, 0}, GuardView{}, kPeriod);
  const GuardReport report = guard.check({NAN, 0, 0}, GuardView{}, kPeriod);
  EXPECT_TRUE(report.not_finite);
  EXPECT_FALSE(report.limited());
  EXPECT_NEAR(report.velocity.x(), 0.1 - 5 * kPeriod, 1e-12);
}

TEST(CommandGuard, ATipThatIsNowhereStops) {
  CommandGuard guard(GuardOptions{});
  EXPECT_EQ(guard.check(Eigen::Vector3d::Zero(), GuardView{}, kPeriod).stop, "");
  EXPECT_NE(guard.check(Eigen::Vector3d::Zero(), at({0, NAN, 0}), kPeriod).stop.find("not finite"), std::string::npos);
}

TEST(CommandGuard, TooMuchForceStopsAndSoDoesAForceThatIsNoNumber) {
  GuardOptions options;
  options.max_force_n = 2;
  for (const double force : {2.1, -2.1, static_cast<double>(NAN)}) {
    CommandGuard guard(options);
    GuardView view;
    view.force_n = 1.9;
    EXPECT_EQ(guard.check({0.1, 0, 0}, view, kPeriod).stop, "");
    view.force_n = force;
    const GuardReport report = guard.check({0.1, 0, 0}, view, kPeriod);
    EXPECT_NE(report.stop.find("force"), std::string::npos);
    EXPECT_TRUE(report.velocity.isZero());
  }
}

TEST(CommandGuard, ALoopThatStaysFarFromItsGoalStops) {
  GuardOptions options;
  options.max_error_m = 0.005;
  options.max_error_s = 0.08;
  CommandGuard guard(options);
  GuardView far;
  far.error_m = 0.006;
  for (int k = 0; k < 9; ++k) EXPECT_EQ(guard.check({0.1, 0, 0}, far, kPeriod).stop, "");
  EXPECT_EQ(guard.check({0.1, 0, 0}, GuardView{}, kPeriod).stop, "");  // back: counted anew
  std::string stop;
  for (int k = 0; k < 12 && stop.empty(); ++k) stop = guard.check({0.1, 0, 0}, far, kPeriod).stop;
  EXPECT_NE(stop.find("diverges"), std::string::npos);
}

TEST(CommandGuard, AcceptsItsDefaultsAndRefusesAStepBeyondTheWorkspace) {
  EXPECT_TRUE(GuardOptions{}.validate().empty());
  GuardOptions options;
  options.max_step_m = 1;
  EXPECT_EQ(options.validate().size(), 1U);
  options = {};
  options.max_speed = options.max_acceleration = options.max_force_n = 0;
  EXPECT_EQ(options.validate().size(), 3U);

}

}  // namespace
}  // namespace heartservo::servo
