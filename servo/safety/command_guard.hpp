#pragma once
// The last gate before the robot: every velocity passes finite check -> speed limit -> acceleration limit -> step
// limit, in this order, and nothing reaches the robot around it.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "tracking/settings/fields.hpp"

namespace heartservo::servo {

struct GuardOptions {
  double max_speed = 0.3;            ///< m/s
  double max_acceleration = 15;      ///< m/s^2
  double max_step_m = 0.0025;        ///< m per period
  double coast_s = 0.15;             ///< s
  double workspace_radius_m = 0.05;  ///< m
  int bad_commands_to_stop = 3;

  void fields(FieldVisitor& v) {
    v.field({"max_speed", "m/s", "fastest commanded speed of the tip", 1e-3, 10}, max_speed);
    v.field({"max_acceleration", "m/s^2", "largest change of the commanded velocity per second", 1e-2, 1e4},
            max_acceleration);
    v.field({"max_step_m", "m", "longest way commanded within one period", 1e-6, 1}, max_step_m);
    v.field({"coast_s", "s", "how long a lost target is followed on its prediction before the tool holds still", 0, 10},
            coast_s);
    v.field({"workspace_radius_m", "m", "a tip further than this from where the run began stops the loop", 1e-3, 10},
            workspace_radius_m);
    v.field({"bad_commands_to_stop", "", "this many commands in a row that are not finite stop the loop", 1, 1000},
            bad_commands_to_stop);
  }
  std::vector<std::string> validate() const;
};

/// What the guard did to one command.
struct GuardReport {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s, allowed
  bool not_finite = false, limited_speed = false, limited_acceleration = false, limited_step = false;
  std::string stop;  ///< "" or the reason for which the loop must end
  bool limited() const { return limited_speed || limited_acceleration || limited_step; }
};

class CommandGuard {
 public:
  explicit CommandGuard(const GuardOptions& options) : options_(options) {}

  /// `wanted` in m/s; `tip` is where the tip is now. The first tip seen is the middle of the workspace.
  GuardReport check(const Eigen::Vector3d& wanted, const Eigen::Vector3d& tip, double period_s);

 private:
  GuardOptions options_;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  bool started_ = false;
  int bad_ = 0;
};

}  // namespace heartservo::servo
