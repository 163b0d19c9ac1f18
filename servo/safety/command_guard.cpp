#include "servo/safety/command_guard.hpp"

#include <fmt/format.h>

#include <cmath>

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

std::string CommandGuard::reason_to_stop(const GuardView& view, double period_s) {
  if (bad_ >= options_.bad_commands_to_stop) return fmt::format("{} commands in a row were not finite", bad_);
  if (!view.tip.allFinite()) return "the place of the tip is not finite";
  if (const double way = (view.tip - middle_).norm(); way > options_.workspace_radius_m)
    return fmt::format("the tip is {:.1f} mm from where the run began; the workspace ends at {:.1f} mm", 1e3 * way,
                       1e3 * options_.workspace_radius_m);
  if (!(std::abs(view.force_n) <= options_.max_force_n))
    return fmt::format("the contact force is {:.2f} N; at most {:.2f} N are allowed", view.force_n,
                       options_.max_force_n);
  far_for_s_ = view.error_m > options_.max_error_m ? far_for_s_ + period_s : 0;
  if (far_for_s_ > options_.max_error_s)
    return fmt::format("the loop diverges: the tip is {:.1f} mm from its goal and was more than {:.1f} mm off for {} s",
                       1e3 * view.error_m, 1e3 * options_.max_error_m, options_.max_error_s);
  return "";
}

GuardReport CommandGuard::check(const Eigen::Vector3d& wanted, const GuardView& view, double period_s) {
  GuardReport report;
  if (!started_ && view.tip.allFinite()) {
    middle_ = view.tip;
    started_ = true;
  }
  Eigen::Vector3d v = wanted;
  report.limited_speed = shorten(v, options_.max_speed);
  Eigen::Vector3d change = v - last_;
  report.limited_acceleration = shorten(change, options_.max_acceleration * period_s);
  v = last_ + change;
  report.limited_step = shorten(v, options_.max_step_m / period_s);
  report.not_finite = !v.allFinite();
  bad_ = report.not_finite ? bad_ + 1 : 0;
  if (report.not_finite) {
    report.limited_speed = report.limited_acceleration = report.limited_step = false;
    change = -last_;
    shorten(change, options_.max_acceleration * period_s);
    v = last_ + change;
  }
  report.stop = reason_to_stop(view, period_s);
  if (!report.stop.empty()) v.setZero();
  last_ = v;
  report.velocity = v;
  return report;
}

}  // namespace heartservo::servo
