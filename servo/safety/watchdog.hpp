#pragma once
// Watches the clockwork: frames that are stale, late or out of order, targets that jump, computing that takes too long.
#include <fmt/format.h>

#include <Eigen/Core>
#include <string>

#include "servo/safety/guard_options.hpp"

namespace heartservo::servo {

class Watchdog {
 public:
  explicit Watchdog(const GuardOptions& options) : options_(options) {}

  /// True for a frame that is new and not too old. `age_s`: how long ago it was exposed; NaN where no clock says.
  bool is_fresh(double frame_time_s, double age_s) {
    const bool later = !any_frame_ || frame_time_s > last_frame_s_;
    if (later) last_frame_s_ = frame_time_s, any_frame_ = true;
    return later && !(options_.max_frame_age_s > 0 && age_s > options_.max_frame_age_s);
  }

  /// True for a position that the target can have reached since it was last seen, one frame or two ago. After a longer
  /// absence anything is possible.
  bool is_plausible(double time_s, const Eigen::Vector3d& target, double period_s) {
    const double dt = time_s - last_target_s_;
    const bool jumped = any_target_ && dt > 0 && dt < 2.5 * period_s &&
                        (target - last_target_).norm() > options_.max_target_speed * dt;
    last_target_ = target, last_target_s_ = time_s, any_target_ = true;  // the next one is judged by this one
    return target.allFinite() && !jumped;
  }

  /// Another target from now on.
  void forget_target() { any_target_ = false; }

  /// "" or why the loop must end.
  std::string computing_time(double chain_s) {
    slow_ = options_.max_chain_s > 0 && chain_s > options_.max_chain_s ? slow_ + 1 : 0;
    if (slow_ < options_.slow_frames_to_stop) return "";
    return fmt::format("{} frames in a row took more than {:.1f} ms to compute; the last {:.1f} ms", slow_,
                       1e3 * options_.max_chain_s, 1e3 * chain_s);
  }

 private:
  GuardOptions options_;
  double last_frame_s_ = 0, last_target_s_ = 0;
  Eigen::Vector3d last_target_ = Eigen::Vector3d::Zero();
  bool any_frame_ = false, any_target_ = false;
  int slow_ = 0;
};

}  // namespace heartservo::servo
