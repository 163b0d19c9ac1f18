#include "servo/robot/robot_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace heartservo::servo {
namespace {

ToolRobotData robot() {
  ToolRobotData data;
  data.bandwidth_hz = 25;
  data.damping = 0.7;
  data.lag_s = 1.4 / (50 * M_PI);
  return data;
}

// A constant velocity from rest: the textbook's ramp response of a second-order system.
TEST(RobotModel, RampResponseIsThatOfASecondOrderSystem) {
  RobotModel model(robot());
  model.command({0, {0.1, 0, 0}});
  const double w = 50 * M_PI, z = 0.7, wd = w * std::sqrt(1 - z * z);
  for (const double t : {0.002, 0.008, 0.02, 0.05}) {
    const double expected = t - 2 * z / w + std::exp(-z * w * t) * (2 * z / w * std::cos(wd * t) +
                                                                    (2 * z * z - 1) / wd * std::sin(wd * t));
    EXPECT_NEAR(model.at(t).tip.x() / 0.1, expected, 1e-7) << t;
  }
}

TEST(RobotModel, AskedForIsTheInverse) {
  const RobotLag lag(robot());
  RobotModel model(robot());
  // ask for the path whose tip is sin: r = p + lag p' + lag2 p'', its velocity commanded every 0.1 ms
  const double w = 2 * M_PI * 3, a = 0.002;
  const auto asked_rate = [&](double t) {
    return a * (w * std::cos(w * t) - lag.lag_s * w * w * std::sin(w * t) - lag.lag2_s2 * w * w * w * std::cos(w * t));
  };
  double worst = 0;
  Eigen::Vector3d start;
  for (int k = 0; k < 6000; ++k) {
    const double t = 1e-4 * k;
    model.command({t, {asked_rate(t + 5e-5), 0, 0}});
    model.advance_to(t + 1e-4);
    if (k == 2999) start = model.state().tip - Eigen::Vector3d(a * std::sin(w * 0.3), 0, 0);
    if (k > 2999) worst = std::max(worst, std::abs(model.state().tip.x() - start.x() - a * std::sin(w * (t + 1e-4))));
  }
  EXPECT_LT(worst, 2e-6);
}

TEST(RobotModel, LooksAheadWithoutMovingAndAgreesWithWhatComes) {
  RobotModel model(robot());
  model.command({0.01, {0.1, -0.05, 0}});
  model.command({0.018, {0.02, 0, 0.03}});
  const RobotState then = model.at(0.03);
  EXPECT_TRUE(model.state().tip.isZero());
  for (double t = 0; t < 0.0305; t += 0.003) model.advance_to(t);
  EXPECT_LT((model.state().tip - then.tip).norm(), 1e-9);
  EXPECT_LT((model.state().reference - Eigen::Vector3d(0.0008 + 0.00024, -0.0004, 0.00036)).norm(), 1e-9);
}

TEST(RobotModel, HoldsTheStatedLimitsAndStopsWhenACommandExpires) {
  ToolRobotData data = robot();
  data.max_speed = 0.1;
  data.max_acceleration = 2;
  RobotModel model(data);
  ToolCommand command{0, {5, 0, 0}};
  command.expires_at_s = 0.2;
  model.command(command);
  EXPECT_NEAR(model.at(0.02).reference_velocity.x(), 0.04, 1e-3);
  EXPECT_NEAR(model.at(0.15).reference_velocity.x(), 0.1, 1e-9);
  EXPECT_NEAR(model.at(0.4).reference_velocity.x(), 0, 1e-9);
  // ramp: lost way v^2 / 2a at the start, the same won at the end
  EXPECT_NEAR(model.at(0.4).reference.x(), 0.02, 2e-5);
}

TEST(RobotModel, WithoutDynamicsTheTipIsTheReference) {
  RobotModel model(ToolRobotData{});
  model.command({0, {0.1, 0, 0}});
  EXPECT_NEAR(model.at(0.1).tip.x(), 0.01, 1e-9);
  EXPECT_EQ(RobotLag(ToolRobotData{}).lag_s, 0);
}

}  // namespace
}  // namespace heartservo::servo
