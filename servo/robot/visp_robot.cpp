#include <visp3/core/vpColVector.h>
#include <visp3/core/vpException.h>
#include <visp3/core/vpRotationMatrix.h>
#include <visp3/core/vpRxyzVector.h>
#include <visp3/robot/vpRobot.h>

#include <string>

#include "servo/robot/visp_robot.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::servo {

namespace {

template <class Action>
auto asked(const char* what, const Action& action) {
  try {
    return action();
  } catch (const vpException& e) {
    throw DeviceError(std::string("the ViSP robot does not ") + what + ": " + e.what());
  }
}

Eigen::Isometry3d pose_of(vpRobot& robot) {
  vpColVector q;
  robot.getPosition(vpRobot::REFERENCE_FRAME, q);
  if (q.size() < 6) throw DeviceError("the ViSP robot tells no pose: give VispRobotOptions::pose");
  const vpRotationMatrix R(vpRxyzVector(q[3], q[4], q[5]));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (unsigned i = 0; i < 3; ++i) {
    pose.translation()(i) = q[i];
    for (unsigned j = 0; j < 3; ++j) pose.linear()(i, j) = R[i][j];
  }
  return pose;
}

}  // namespace

VispRobot::VispRobot(vpRobot& robot, VispRobotOptions options) : robot_(robot), options_(std::move(options)) {
  if (!options_.pose) options_.pose = pose_of;
  if (options_.data.max_speed <= 0) options_.data.max_speed = robot.getMaxTranslationVelocity();
  R_start_ = pose().linear();
}

Eigen::Isometry3d VispRobot::pose() const {
  return asked("tell its pose", [&] { return options_.pose(robot_); });
}

ToolState VispRobot::read(double time_s) {
  const Eigen::Isometry3d T = pose();
  ToolState state;
  state.time_s = time_s;
  state.tip = T * options_.tip_m;
  state.velocity = sent_;
  state.R_start_tool = T.linear() * R_start_.transpose();
  return state;
}

void VispRobot::command(const ToolCommand& command) {
  queue_[given_ % queue_.size()] = command;
  ++given_;
}

void VispRobot::send_due(double time_s) {
  while (taken_ < given_ && queue_[taken_ % queue_.size()].acts_at_s <= time_s + 1e-9) ++taken_;
  if (taken_ == 0) return send(Eigen::Vector3d::Zero());
  const ToolCommand& last = queue_[(taken_ - 1) % queue_.size()];
  send(time_s < last.expires_at_s ? last.velocity : Eigen::Vector3d::Zero());
}

void VispRobot::send(const Eigen::Vector3d& velocity) {
  const Eigen::Vector3d v =
      options_.sends_in_reference_frame ? velocity : Eigen::Vector3d(pose().linear().transpose() * velocity);
  asked("take a velocity", [&] {
    if (robot_.getRobotState() != vpRobot::STATE_VELOCITY_CONTROL)
      robot_.setRobotState(vpRobot::STATE_VELOCITY_CONTROL);
    vpColVector twist(6);
    for (unsigned i = 0; i < 3; ++i) twist[i] = v(i);
    robot_.setVelocity(options_.sends_in_reference_frame ? vpRobot::REFERENCE_FRAME : vpRobot::CAMERA_FRAME, twist);
  });
  sent_ = velocity;
}

void VispRobot::stop() {
  asked("stop", [&] { robot_.setRobotState(vpRobot::STATE_STOP); });
}

}  // namespace heartservo::servo
