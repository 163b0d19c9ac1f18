#include "servo/control/force_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "servo/robot/robot_model.hpp"
#include "servo/safety/run_checks.hpp"
#include "sim/tissue/kelvin_voigt.hpp"

namespace heartservo::servo {
namespace {

constexpr double kPeriod = 0.008, kLatency = 0.024;

ToolRobotData robot_of() {
  ToolRobotData data;
  data.bandwidth_hz = 25;
  data.lag_s = 2 * 0.7 / (2 * M_PI * 25);
  return data;
}

struct Outcome {
  double peak = 0, late_error = 0, after = 0;
  int touches = 0;
};

// Tissue that stands still; the tip follows the depth through latency and robot. Presses from 0.5 to 5 s.
Outcome press(const ForceOptions& options, double stiffness) {
  const sim::TissueOptions tissue{stiffness, 2e-3 * stiffness, 0};
  ForceLoop loop(options);
  RobotModel robot(robot_of());
  Outcome o;
  double force = 0;
  bool touching = false;
  for (double t = 0; t < 7; t += kPeriod) {
    robot.advance_to(t);
    const double depth = robot.state().tip.x() - 0.001;  // the surface lies 1 mm below the offset
    force = sim::contact_force(tissue, depth, robot.state().tip_velocity.x());
    o.touches += force > 0 && !touching;
    touching = force > 0;
    loop.update(t, force, kPeriod, true);
    const double then = t + kLatency, wanted = loop.depth(t + kPeriod);
    robot.command({then, {(wanted - robot.at(then).reference.x()) / kPeriod, 0, 0}});
    o.peak = std::max(o.peak, force);
    if (t > 3 && t < 5) o.late_error = std::max(o.late_error, std::abs(force - options.wanted_n));
    if (t > 6) o.after = std::max(o.after, force);
  }
  return o;
}

ForceOptions pressing() {
  ForceOptions options;
  options.wanted_n = 0.5;
  options.start_s = 0.5;
  options.end_s = 5;
  return options;
}

TEST(ForceLoop, PressesAndLetsGoWithoutBounceOverTheStatedRangeOfStiffness) {
  for (const double stiffness : {100.0, 300.0, 600.0, 1000.0}) {
    const Outcome o = press(pressing(), stiffness);
    EXPECT_LT(o.late_error, 0.01) << stiffness;
    EXPECT_LT(o.peak, 0.5 * 1.25) << stiffness;
    EXPECT_EQ(o.touches, 1) << stiffness;
    EXPECT_EQ(o.after, 0) << stiffness;
  }
}

TEST(ForceLoop, IsUnstableWhereTheCheckSaysSo) {
  ForceOptions options = pressing();
  options.approach_speed = 0.05;
  const double stiffness = 1.3 * largest_stable_gain(kLatency + 0, kPeriod, robot_of()) / options.gain;
  EXPECT_GT(press(options, stiffness).late_error, 0.2);
}

TEST(ForceLoop, LetsGoWhenTheTargetIsNotFollowedOrTheSensorFails) {
  for (const bool sensor_fails : {false, true}) {
    ForceLoop loop(pressing());
    for (double t = 0; t < 3; t += kPeriod) loop.update(t, t > 1 ? 0.3 : 0, kPeriod, true);
    EXPECT_EQ(loop.phase(), ForcePhase::PRESS);
    const double deep = loop.depth(3);
    EXPECT_GT(deep, 0);
    loop.update(3, sensor_fails ? NAN : 0.3, kPeriod, sensor_fails);
    EXPECT_EQ(loop.phase(), ForcePhase::RELEASE);
    EXPECT_LT(loop.depth(3 + kPeriod), deep);
  }
}

TEST(ForceLoop, GoesNoDeeperThanAllowedAndIsOffWithoutAForce) {
  ForceOptions options = pressing();
  options.max_depth_m = 0.002;
  ForceLoop loop(options);
  for (double t = 0; t < 3; t += kPeriod) loop.update(t, 0, kPeriod, true);
  EXPECT_NEAR(loop.depth(3), 0.002, 1e-9);
  ForceLoop off{ForceOptions{}};
  for (double t = 0; t < 6; t += kPeriod) off.update(t, 0, kPeriod, true);
  EXPECT_EQ(off.depth(6), 0);
}

TEST(KelvinVoigt, PushesAndNeverPulls) {
  const sim::TissueOptions tissue{300, 2, 0};
  EXPECT_EQ(sim::contact_force(tissue, -1e-4, 1), 0);
  EXPECT_DOUBLE_EQ(sim::contact_force(tissue, 1e-3, 0.01), 0.32);
  EXPECT_EQ(sim::contact_force(tissue, 1e-4, -0.5), 0);
}

}  // namespace
}  // namespace heartservo::servo
