#include <gtest/gtest.h>

#include <cmath>

#include "sim/robot/registry.hpp"
#include "sim/robot/trocar_kinematics.hpp"
#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/random.hpp"

namespace heartservo::sim {
namespace {

const Eigen::Vector3d kTip(0.002, 0.004, 0.054), kAxis = Eigen::Vector3d(0.72, 0.57, -0.36).normalized();

RobotSetup trocar() {
  RobotSetup setup;
  setup.options.type = "trocar";
  setup.options.encoder_noise_m = 0;
  setup.tip_camera = kTip;
  setup.tool_axis = kAxis;
  return setup;
}

TEST(TrocarKinematics, StartsAtTheTipAndTheShaftGoesThroughThePort) {
  auto random = test::seeded();
  const TrocarKinematics k(kTip, kAxis, 0.12);
  EXPECT_LT((k.tip(Eigen::Vector4d::Zero()) - kTip).norm(), 1e-15);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector4d q(test::uniform(random, -0.5, 0.5), test::uniform(random, -0.5, 0.5),
                            test::uniform(random, -0.04, 0.04), test::uniform(random, -3, 3));
    const Eigen::Vector3d shaft = k.R_base_tool(q).col(2);
    EXPECT_LT((k.port - k.tip(q)).cross(shaft).norm(), 1e-12);
    Eigen::Vector4d without_roll = q;
    without_roll[3] = 0;
    EXPECT_LT((k.joints_of(k.tip(q)) - without_roll).norm(), 1e-12);
  }
}

TEST(TrocarKinematics, JacobianIsThatOfTheTip) {
  const TrocarKinematics k(kTip, kAxis, 0.12);
  const Eigen::Vector4d q(0.2, -0.3, 0.02, 0.4);
  const Eigen::Matrix3d J = k.jacobian(q);
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector4d up = q, down = q;
    up[i] += 1e-6, down[i] -= 1e-6;
    EXPECT_LT((J.col(i) - (k.tip(up) - k.tip(down)) / 2e-6).norm(), 1e-9) << i;
  }
}

TEST(TrocarRobot, FollowsATipVelocityAsTheCartesianRobotDoes) {
  RobotSetup setup = trocar();
  const auto robot = make_robot(setup);
  setup.options.type = "cartesian";
  const auto cartesian = make_robot(setup);
  double worst = 0;
  for (int k = 0; k < 500; ++k) {
    const double t = 0.008 * k, w = 2 * M_PI * 1.5;
    const servo::ToolCommand c{t, 0.004 * w * std::cos(w * t) * Eigen::Vector3d(0.6, 0.5, 0.62)};
    robot->command(c);
    cartesian->command(c);
    robot->advance_to(t + 0.008);
    cartesian->advance_to(t + 0.008);
    worst = std::max(worst, (robot->true_tip_camera() - cartesian->true_tip_camera()).norm());
    EXPECT_LT((robot->data().R_camera_base * robot->read(t + 0.008).tip + robot->data().t_camera_base -
               robot->true_tip_camera())
                  .norm(),
              1.3e-3);  // encoders: wrong by the stated calibration error only
  }
  EXPECT_LT(worst, 2e-4);  // on a swing of 4 mm, each way
}

TEST(TrocarRobot, HoldsThePortToATenthOfAMillimetreAndTurnsTheTool) {
  const auto robot = make_robot(trocar());
  double turned = 0;
  for (int k = 0; k < 500; ++k) {
    const double t = 0.008 * k;
    robot->command({t, {0.05 * std::cos(9 * t), 0.05 * std::sin(7 * t), 0.04 * std::cos(5 * t)}});
    robot->advance_to(t + 0.008);
    EXPECT_LT(robot->port_deviation_m(), 1e-4);
    turned = std::max(turned, Eigen::AngleAxisd(robot->true_turn_camera()).angle());
    // what the encoders say of the turn agrees with the truth
    const Eigen::Matrix3d R = robot->data().R_camera_base;
    const Eigen::Matrix3d said = R * robot->read(t + 0.008).R_start_tool * R.transpose();
    EXPECT_LT(Eigen::AngleAxisd(said.transpose() * robot->true_turn_camera()).angle(), 0.0175 * 0.2);
  }
  EXPECT_GT(robot->port_deviation_m(), 0);
  EXPECT_GT(turned, 0.02);
}

TEST(TrocarRobot, StopsAtItsJointLimits) {
  RobotSetup setup = trocar();
  setup.options.max_insertion_m = 0.005;
  setup.options.max_pivot_rad = 0.05;
  const auto robot = make_robot(setup);
  const Eigen::Matrix3d R = robot->data().R_camera_base;
  robot->command({0, R.transpose() * (-0.05 * kAxis)});
  robot->advance_to(2);
  EXPECT_NEAR((robot->true_tip_camera() - kTip).norm(), 0.005, 3e-4);
  const auto sideways = make_robot(setup);
  sideways->command({0, R.transpose() * (0.05 * kAxis.unitOrthogonal())});
  sideways->advance_to(3);
  // the corner of all three limits; a straight way sideways needs insertion as well
  const double pivot = 1.01 * (0.12 + 0.005) * 0.05;
  EXPECT_LT((sideways->true_tip_camera() - kTip).norm(), std::sqrt(2 * pivot * pivot + 0.005 * 0.005));
}

TEST(Robots, EveryOneStartsWhereItIsPutAndStopsWhenACommandExpires) {
  for (const auto& name : robots().names()) {
    RobotSetup setup = trocar();
    setup.options.type = name;
    const auto robot = make_robot(setup);
    EXPECT_LT((robot->true_tip_camera() - kTip).norm(), 1e-12) << name;
    servo::ToolCommand command{0.1, {0.02, 0, 0}};
    command.expires_at_s = 0.3;
    robot->command(command);
    robot->advance_to(0.1);
    EXPECT_LT((robot->true_tip_camera() - kTip).norm(), 1e-9) << name;
    robot->advance_to(1);
    EXPECT_NEAR((robot->true_tip_camera() - kTip).norm(), 0.004, 1e-4) << name;
    const Eigen::Vector3d there = robot->true_tip_camera();
    robot->advance_to(2);
    EXPECT_LT((robot->true_tip_camera() - there).norm(), 1e-9) << name;
  }
}

}  // namespace
}  // namespace heartservo::sim
