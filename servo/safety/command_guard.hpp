#pragma once
// The last gate before the robot: every velocity passes speed limit -> acceleration limit -> step limit -> finite
// check, in this order, and nothing reaches the robot around it.
#include <Eigen/Core>
#include <string>

#include "servo/safety/guard_options.hpp"

namespace heartservo::servo {

/// What the guard did to one command.
struct GuardReport {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s, allowed
  bool not_finite = false, limited_speed = false, limited_acceleration = false, limited_step = false;
  std::string stop;  ///< "" or the reason for which the loop must end
  bool limited() const { return limited_speed || limited_acceleration || limited_step; }
};

/// What the guard is told beside the command.
struct GuardView {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  ///< where the tip is now, m
  double error_m = 0;                             ///< distance of tip and goal; 0 where none is followed
  double force_n = 0;                             ///< N
};

class CommandGuard {
 public:
  explicit CommandGuard(const GuardOptions& options) : options_(options) {}

  /// `wanted` in m/s. The first tip seen is the middle of the workspace. A command that is not finite becomes the
  /// hardest braking allowed.
  GuardReport check(const Eigen::Vector3d& wanted, const GuardView& view, double period_s);

 private:
  std::string reason_to_stop(const GuardView& view, double period_s);

  GuardOptions options_;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  bool started_ = false;
  int bad_ = 0;
  double far_for_s_ = 0;
};

}  // namespace heartservo::servo
