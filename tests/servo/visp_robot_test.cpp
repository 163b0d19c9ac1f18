// The adapter for any vpRobot, on ViSP's own free-flying camera and on robots that only listen.
#include "servo/robot/visp_robot.hpp"

#include <gtest/gtest.h>
#include <visp3/core/vpException.h>
#include <visp3/robot/vpSimulatorCamera.h>

#include <string>

#include "tracking/settings/errors.hpp"

namespace heartservo::servo {
namespace {

TEST(VispRobot, MovesTheTipAlongTheReferenceFramesAxes) {
  vpSimulatorCamera camera;
  camera.setPosition(vpHomogeneousMatrix(0.1, -0.2, 0.3, 0.4, -0.5, 0.6));
  camera.setMaxTranslationVelocity(0.4);
  VispRobotOptions options;
  options.tip_m = Eigen::Vector3d(0, 0, 0.1);
  VispRobot robot(camera, options);
  EXPECT_EQ(robot.data().max_speed, 0.4);
  const ToolState before = robot.read(0);
  vpHomogeneousMatrix wMc;
  camera.getPosition(wMc);
  for (unsigned i = 0; i < 3; ++i) EXPECT_NEAR(before.tip(i), wMc[i][3] + 0.1 * wMc[i][2], 1e-9);
  camera.setSamplingTime(0.01);
  robot.command({0.05, {0.1, 0, -0.05}});
  robot.command({0.08, {0, 0.2, 0}, 0.15});
  for (int k = 0; k < 20; ++k) robot.send_due(0.01 * k);
  const ToolState after = robot.read(0.2);
  EXPECT_LT((after.tip - before.tip - Eigen::Vector3d(0.003, 0.2 * 0.07, -0.0015)).norm(), 1e-9);
  EXPECT_LT((after.R_start_tool - Eigen::Matrix3d::Identity()).norm(), 1e-9);
}

TEST(VispRobot, StandsStillWithoutCommands) {
  vpSimulatorCamera camera;
  VispRobot robot(camera, {});
  robot.send_due(1);
  EXPECT_LT(robot.read(1).tip.norm(), 1e-12);
}

TEST(VispRobot, SendsInTheReferenceFrameWhereAsked) {
  struct Listens final : vpRobot {
    vpControlFrameType frame = vpRobot::CAMERA_FRAME;
    vpColVector sent;
    void get_eJe(vpMatrix&) override {}
    void get_fJe(vpMatrix&) override {}
    void getDisplacement(const vpRobot::vpControlFrameType, vpColVector&) override {}
    void getPosition(const vpRobot::vpControlFrameType, vpColVector&) override {}
    void init() override {}
    void setPosition(const vpRobot::vpControlFrameType, const vpColVector&) override {}
    void setVelocity(const vpRobot::vpControlFrameType f, const vpColVector& v) override { frame = f, sent = v; }
  } listens;
  VispRobotOptions options;
  options.sends_in_reference_frame = true;
  options.pose = [](vpRobot&) {  // a robot that tells its pose in its own way
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
    return pose;
  };
  VispRobot robot(listens, options);
  robot.command({0, {0.1, 0.2, 0.3}});
  robot.send_due(0);
  EXPECT_EQ(listens.frame, vpRobot::REFERENCE_FRAME);
  ASSERT_EQ(listens.sent.size(), 6U);
  EXPECT_EQ(listens.sent[1], 0.2);
  EXPECT_EQ(listens.sent[4], 0);
  EXPECT_EQ(listens.getRobotState(), vpRobot::STATE_VELOCITY_CONTROL);
  robot.stop();
  EXPECT_EQ(listens.getRobotState(), vpRobot::STATE_STOP);
}

TEST(VispRobot, ARobotThatRefusesIsADeviceError) {
  struct Broken final : vpRobot {
    void get_eJe(vpMatrix&) override {}
    void get_fJe(vpMatrix&) override {}
    void getDisplacement(const vpRobot::vpControlFrameType, vpColVector&) override {}
    void getPosition(const vpRobot::vpControlFrameType, vpColVector& q) override { q.resize(6); }
    void init() override {}
    void setPosition(const vpRobot::vpControlFrameType, const vpColVector&) override {}
    void setVelocity(const vpRobot::vpControlFrameType, const vpColVector&) override {
      throw vpException(vpException::fatalError, "no power");
    }
  } broken;
  VispRobot robot(broken, {});
  robot.command({0, {0.1, 0, 0}});
  try {
    robot.send_due(1);
    FAIL();
  } catch (const DeviceError& e) {
    EXPECT_NE(std::string(e.what()).find("no power"), std::string::npos);
  }
}

}  // namespace
}  // namespace heartservo::servo
