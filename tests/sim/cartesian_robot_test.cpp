#include "sim/robot/cartesian_robot.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace heartservo::sim {
namespace {

const Eigen::Vector3d kStart(0.002, -0.001, 0.055);

RobotOptions quiet() {
  RobotOptions options;
  options.encoder_noise_m = 0;
  return options;
}

TEST(CartesianRobot, StartsWhereItIsPutAndStands) {
  CartesianRobot robot(quiet(), kStart, 1);
  robot.advance_to(1);
  EXPECT_LT((robot.true_tip_camera() - kStart).norm(), 1e-12);
}

TEST(CartesianRobot, FollowsAConstantVelocityLateByItsStatedLag) {
  CartesianRobot robot(quiet(), kStart, 1);
  const Eigen::Vector3d v(0.02, -0.01, 0.03);
  robot.command({0.1, v});
  robot.advance_to(1.1);
  const Eigen::Vector3d v_camera = (robot.true_tip_camera() -
                                    [&] {
                                      CartesianRobot before(quiet(), kStart, 1);
                                      before.command({0.1, v});
                                      before.advance_to(1.0);
                                      return before.true_tip_camera();
                                    }()) /
                                   0.1;
  EXPECT_NEAR(v_camera.norm(), v.norm(), 1e-6);
  // acceleration-limited start: the reference loses v / (2 a) of time, the servo another lag
  const double start = v.norm() / quiet().max_acceleration / 2;
  const double late = 1.0 - (robot.true_tip_camera() - kStart).norm() / v.norm();
  EXPECT_NEAR(late, robot.data().lag_s + start, 3e-4);
}

TEST(CartesianRobot, AmplitudeAtTheBandwidthIsThatOfASecondOrderSystem) {
  RobotOptions options = quiet();
  options.max_acceleration = 1e4;
  options.max_speed = 10;
  CartesianRobot robot(options, kStart, 1);
  const double w = 2 * M_PI * options.bandwidth_hz, amplitude = 0.0005;
  double largest = 0;
  for (int k = 0; k < 4000; ++k) {
    const double t = 2.5e-4 * k;
    robot.command({t, Eigen::Vector3d(amplitude * w * std::cos(w * t), 0, 0)});
    robot.advance_to(t + 2.5e-4);
    if (t > 0.5) largest = std::max(largest, (robot.true_tip_camera() - kStart).norm());
  }
  EXPECT_NEAR(largest / amplitude, 1 / (2 * options.damping), 0.04);
}

TEST(CartesianRobot, HoldsSpeedAndAccelerationLimits) {
  RobotOptions options = quiet();
  options.max_speed = 0.1;
  options.max_acceleration = 2;
  CartesianRobot robot(options, kStart, 1);
  robot.command({0, Eigen::Vector3d(5, 0, 0)});
  Eigen::Vector3d last = robot.true_tip_camera(), last_v = Eigen::Vector3d::Zero();
  double speed = 0, acceleration = 0;
  for (int k = 1; k < 400; ++k) {
    robot.advance_to(0.001 * k);
    const Eigen::Vector3d v = (robot.true_tip_camera() - last) / 0.001;
    speed = std::max(speed, v.norm());
    acceleration = std::max(acceleration, (v - last_v).norm() / 0.001);
    last = robot.true_tip_camera();
    last_v = v;
  }
  EXPECT_NEAR(speed, 0.1, 0.006);  // a damping of 0.7 overshoots a little
  EXPECT_LT(acceleration, 2 * 1.3);
}

TEST(CartesianRobot, StatedCalibrationIsWrongByWhatIsStated) {
  RobotOptions options = quiet();
  options.calibration_error_m = 0.001;
  options.calibration_error_rad = 0.02;
  CartesianRobot robot(options, kStart, 5);
  const auto data = robot.data();
  const auto state = robot.read(0);
  EXPECT_NEAR((data.R_camera_base * state.tip + data.t_camera_base - kStart).norm(), 0.001, 1e-9);
  CartesianRobot right(
      [&] {
        RobotOptions o = options;
        o.calibration_error_m = o.calibration_error_rad = 0;
        return o;
      }(),
      kStart, 5);
  EXPECT_NEAR(Eigen::AngleAxisd(data.R_camera_base * right.data().R_camera_base.transpose()).angle(), 0.02, 1e-9);
  EXPECT_LT((right.data().R_camera_base * right.read(0).tip + right.data().t_camera_base - kStart).norm(), 1e-12);
}

TEST(CartesianRobot, EncodersAreNoisyAndRepeatBySeed) {
  RobotOptions options;
  options.encoder_noise_m = 1e-5;
  CartesianRobot a(options, kStart, 3), b(options, kStart, 3), c(options, kStart, 4);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  const int n = 2000;
  for (int k = 0; k < n; ++k) {
    const Eigen::Vector3d tip = a.read(0.001 * k).tip;
    EXPECT_EQ(tip, b.read(0.001 * k).tip);
    EXPECT_NE(tip, c.read(0.001 * k).tip);
    sum += tip;
    squares += tip.cwiseAbs2();
  }
  const Eigen::Vector3d variance = squares / n - (sum / n).cwiseAbs2();
  EXPECT_NEAR(std::sqrt(variance.mean()), 1e-5, 5e-7);
}

TEST(CartesianRobot, IdealFollowsItsReferenceAtOnce) {
  RobotOptions options = quiet();
  options.type = "ideal";
  CartesianRobot robot(options, kStart, 1);
  robot.command({0.1, Eigen::Vector3d(0.1, 0, 0)});
  robot.advance_to(0.2);
  EXPECT_NEAR((robot.true_tip_camera() - kStart).norm(), 0.01, 2e-5);
  EXPECT_EQ(robot.data().lag_s, 0);
}

}  // namespace
}  // namespace heartservo::sim
