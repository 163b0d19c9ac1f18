#include <gtest/gtest.h>

#include "servo/control/feed_forward.hpp"
#include "servo/control/registry.hpp"
#include "tests/support/random.hpp"

namespace heartservo::servo {
namespace {

ControlState state_of(const Eigen::Vector3d& tip, const Eigen::Vector3d& goal, const Eigen::Vector3d& goal_velocity) {
  ControlState s;
  s.period_s = 0.008;
  s.tip_now = s.robot.reference = s.robot.tip = tip;
  s.last_velocity.setZero();
  s.goal_now = goal;
  s.goal_then.valid = true;
  s.goal_then.position = goal;
  s.goal_then.velocity = goal_velocity;
  for (int k = -1; k <= kLongestHorizon; ++k) {
    auto& g = s.goals[static_cast<std::size_t>(k + 1)] = s.goal_then;
    g.position = goal + k * s.period_s * goal_velocity;
  }
  return s;
}

Eigen::Vector3d features(const Eigen::Vector3d& p) { return {p.x() / p.z(), p.y() / p.z(), std::log(p.z())}; }

// The law's promise: each feature error decays as exp(-gain t).
TEST(Ibvs, EachFeatureErrorDecaysAtTheGain) {
  const Eigen::Vector3d tip(0.004, -0.003, 0.052), goal(0.001, 0.002, 0.056);
  const auto law = control_laws().make("ibvs", ControlSetup{ControlOptions{7, 30}});
  const Eigen::Vector3d v = law->velocity(state_of(tip, goal, {1, 1, 1}));
  const double dt = 1e-6;
  const Eigen::Vector3d rate = (features(tip + v * dt) - features(tip)) / dt;
  EXPECT_LT((rate + 7 * (features(tip) - features(goal))).norm(), 1e-4);
}

// ibvs is ViSP's vpServo; ibvs_feedforward inverts the interaction matrix by hand.
TEST(Ibvs, WithFeedForwardTheLawIsThatOfVpServo) {
  auto random = test::seeded();
  ControlSetup setup;
  setup.options.gain = setup.options.gain_feedforward = 11;
  const auto visp = control_laws().make("ibvs", setup), own = control_laws().make("ibvs_feedforward", setup);
  for (int trial = 0; trial < 50; ++trial) {
    const auto somewhere = [&] {
      return Eigen::Vector3d(test::normal(random, 0.01), test::normal(random, 0.01),
                             0.055 + test::normal(random, 0.005));
    };
    const ControlState state = state_of(somewhere(), somewhere(), Eigen::Vector3d::Zero());
    const Eigen::Vector3d expected = visp->velocity(state);
    EXPECT_LT((own->velocity(state) - expected).norm(), 1e-9 * (1 + expected.norm()));
  }
}

TEST(Ibvs, ReachesAStillGoal) {
  for (const auto& name : control_laws().names()) {
    const auto law = control_laws().make(name, {});
    Eigen::Vector3d tip(0.006, -0.004, 0.048);
    const Eigen::Vector3d goal(0.0, 0.003, 0.057);
    for (int k = 0; k < 250; ++k) tip += 0.008 * law->velocity(state_of(tip, goal, Eigen::Vector3d::Zero()));
    EXPECT_LT((tip - goal).norm(), 1e-6) << name;
  }
}

TEST(Ibvs, OnTheGoalNothingIsLeftToCorrect) {
  const Eigen::Vector3d p(0.001, 0.002, 0.055), velocity(0.03, -0.02, 0.05);
  for (const char* name : {"ibvs", "ibvs_feedforward"})
    EXPECT_LT(control_laws().make(name, {})->velocity(state_of(p, p, velocity)).norm(), 1e-12) << name;
  EXPECT_TRUE(control_laws().make("ibvs_feedforward", {})->wants_feed_forward());
  EXPECT_FALSE(control_laws().make("ibvs", {})->wants_feed_forward());
}

TEST(FeedForward, IsTheGoalsVelocityWhereItIsConstant) {
  const Eigen::Vector3d p(0.001, 0.002, 0.055), velocity(0.03, -0.02, 0.05);
  ToolRobotData robot;
  robot.bandwidth_hz = 25;
  const RobotLag lag(robot);
  EXPECT_LT((feed_forward(state_of(p, p, velocity), lag) - velocity).norm(), 1e-12);
  EXPECT_LT((asked_goal(state_of(p, p, velocity), lag, 0) - p - lag.lag_s * velocity).norm(), 1e-12);
}

TEST(Ibvs, PointsBehindTheCameraGiveNoFiniteVelocity) {
  for (const char* name : {"ibvs", "ibvs_feedforward"}) {
    const auto law = control_laws().make(name, {});
    EXPECT_FALSE(law->velocity(state_of({0, 0, -0.01}, {0, 0, 0.05}, Eigen::Vector3d::Zero())).allFinite());
    EXPECT_FALSE(law->velocity(state_of({0, 0, 0.05}, {0, NAN, 0.05}, Eigen::Vector3d::Zero())).allFinite());
  }
}

}  // namespace
}  // namespace heartservo::servo
