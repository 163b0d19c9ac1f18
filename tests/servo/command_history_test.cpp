#include "servo/loop/command_history.hpp"

#include <gtest/gtest.h>

#include "servo/robot/tip_estimator.hpp"
#include "tests/support/random.hpp"

namespace heartservo::servo {
namespace {

TEST(CommandHistory, IntegratesPiecewiseConstantVelocity) {
  CommandHistory history;
  EXPECT_TRUE(history.way_between(0, 1).isZero());
  history.add(1.0, {1, 0, 0});
  history.add(2.0, {0, 2, 0});
  EXPECT_LT((history.way_between(0, 1.5) - Eigen::Vector3d(0.5, 0, 0)).norm(), 1e-12);
  EXPECT_LT((history.way_between(1.25, 2.5) - Eigen::Vector3d(0.75, 1, 0)).norm(), 1e-12);
  EXPECT_TRUE(history.way_between(0, 0.9).isZero());
  EXPECT_TRUE(history.way_between(2, 1).isZero());
}

TEST(CommandHistory, KeepsTheNewestWhenFull) {
  CommandHistory history;
  for (int k = 0; k < 1000; ++k) history.add(0.008 * k, {k < 900 ? 1.0 : 2.0, 0, 0});
  EXPECT_NEAR(history.way_between(0.008 * 900, 0.008 * 1000).x(), 1.6, 1e-9);
}

TEST(TipEstimator, LearnsTheCalibrationErrorFromTheMarkerAndKeepsItWhenTheMarkerIsGone) {
  auto random = test::seeded();
  ToolRobotData robot;
  robot.t_camera_base = {0.001, 0, 0};  // 1 mm wrong
  TipEstimator estimator(TipOptions{}, robot, Eigen::Vector3d(0, 0.004, 0));
  Eigen::Vector3d tip, estimate;
  tracking::TargetState marker;
  for (int k = 0; k < 500; ++k) {
    tip = Eigen::Vector3d(0.002 * std::sin(0.05 * k), 0, 0.055);
    marker.time_s = 0.008 * k;
    marker.state = k < 400 ? tracking::TrackState::OK : tracking::TrackState::LOST;
    marker.T_camera_target.translation() = tip - Eigen::Vector3d(0, 0.004, 0);
    for (int i = 0; i < 3; ++i) marker.T_camera_target.translation()[i] += test::normal(random, 1e-4);
    estimate = estimator.estimate({marker.time_s, tip, Eigen::Vector3d::Zero()}, marker);
  }
  EXPECT_LT((estimate - tip).norm(), 5e-5);
  EXPECT_NEAR(estimator.offset().x(), -0.001, 5e-5);
}

}  // namespace
}  // namespace heartservo::servo
