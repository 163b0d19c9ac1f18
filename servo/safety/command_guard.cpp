#include "servo/safety/command_guard.hpp"

#include <fmt/format.h>

namespace heartservo::servo {

namespace {

// Shortens v to `longest`; true if it had to.
bool shorten(Eigen::Vector3d& v, double longest) {
  const double length = v.norm();
  if (length <= longest) return false;
  v *= longest / length;
  return true;
}

}  // namespace

std::vector<std::string> GuardOptions::validate() const {
  std::vector<std::string> problems;
  if (max_step_m > workspace_radius_m)
    problems.push_back("loop.guard.max_step_m is longer than loop.guard.workspace_radius_m");
  return problems;
}

GuardReport CommandGuard::check(const Eigen::Vector3d& wanted, const Eigen::Vector3d& tip, double period_s) {
  GuardReport report;
  if (!started_ && tip.allFinite()) {
    middle_ = tip;
    started_ = true;
  }
  Eigen::Vector3d v = wanted;
  if (!v.allFinite()) {
    report.not_finite = true;
    v.setZero();
    if (++bad_ >= options_.bad_commands_to_stop)
      report.stop = fmt::format("{} commands in a row were not finite", bad_);
  } else {
    bad_ = 0;
  }
  report.limited_speed = shorten(v, options_.max_speed);
  Eigen::Vector3d change = v - last_;
  report.limited_acceleration = shorten(change, options_.max_acceleration * period_s);
  v = last_ + change;
  report.limited_step = shorten(v, options_.max_step_m / period_s);
  if (report.stop.empty() && (!tip.allFinite() || (tip - middle_).norm() > options_.workspace_radius_m))
    report.stop = fmt::format("the tip is {:.1f} mm from where the run began; the workspace ends at {:.1f} mm",
                              1e3 * (tip - middle_).norm(), 1e3 * options_.workspace_radius_m);
  if (!report.stop.empty()) v.setZero();
  last_ = v;
  report.velocity = v;
  return report;
}

}  // namespace heartservo::servo
