#pragma once
// Any vpRobot as the loop's ToolRobot: velocities go in, poses come out, and a laboratory's own ViSP robot needs no code
// of ours. The caller owns the vpRobot, which must be ready for velocity control, and the clock: send_due() passes on
// the commands whose time has come, from a timer or once a frame.
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <functional>

#include "servo/robot/tool_robot.hpp"

class vpRobot;

namespace heartservo::servo {

struct VispRobotOptions {
  /// What is known of the robot: where its reference frame is in the camera frame, its speed and lag. A max_speed of 0
  /// takes the vpRobot's own.
  ToolRobotData data;
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();  ///< the tool's tip in the frame whose pose the robot tells
  /// False: velocities are sent in that moving frame (vpRobot::CAMERA_FRAME, which every ViSP robot knows). True: in
  /// the robot's fixed one (vpRobot::REFERENCE_FRAME).
  bool sends_in_reference_frame = false;
  /// Pose of the moving frame in the reference frame. Empty: vpRobot::getPosition(REFERENCE_FRAME) as a translation
  /// and ViSP's rxyz angles, which is what vpRobotAfma6, vpRobotViper850, vpSimulatorAfma6 and vpSimulatorCamera give.
  std::function<Eigen::Isometry3d(vpRobot&)> pose;
};

class VispRobot final : public ToolRobot {
 public:
  VispRobot(vpRobot& robot, VispRobotOptions options);

  ToolRobotData data() const override { return options_.data; }
  /// Throws DeviceError when the robot does not answer.
  ToolState read(double time_s) override;
  void command(const ToolCommand& command) override;

  /// Sends the newest command that acts at `time_s` or before, or a stop when it has expired. Throws DeviceError when
  /// the robot refuses.
  void send_due(double time_s);

  /// Stops the motion and leaves velocity control.
  void stop();

  Eigen::Isometry3d pose() const;  ///< of the moving frame in the reference frame
  const Eigen::Vector3d& sent() const { return sent_; }  ///< last velocity sent, reference frame, m/s
  Eigen::Vector3d tip_m() const { return options_.tip_m; }

 private:
  void send(const Eigen::Vector3d& velocity);

  vpRobot& robot_;
  VispRobotOptions options_;
  Eigen::Matrix3d R_start_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d sent_ = Eigen::Vector3d::Zero();
  std::array<ToolCommand, 256> queue_{};
  std::size_t given_ = 0, taken_ = 0;
};

}  // namespace heartservo::servo
