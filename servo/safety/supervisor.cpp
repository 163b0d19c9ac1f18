#include "servo/safety/supervisor.hpp"

namespace heartservo::servo {

namespace {

constexpr double kRejoin_s =
    0.05;  // after a longer coast the goal is not where it was foreseen, and the way back is gone slowly

}  // namespace

void Supervisor::enter(LoopMode mode, double time_s) {
  if (mode == mode_) return;
  mode_ = mode;
  since_s_ = time_s;
}

LoopMode Supervisor::update(double time_s, bool seen, bool known) {
  const double unseen_s = time_s - last_seen_s_;  // also long when the camera itself dropped out
  const bool in_a_row = seen && unseen_s <= options_.coast_s;
  seen_in_a_row_ = in_a_row ? seen_in_a_row_ + 1 : seen ? 1 : 0;
  if (seen) last_seen_s_ = time_s;
  if (!ever_followed_) {
    ever_followed_ = seen && known;
    if (ever_followed_) enter(LoopMode::FOLLOW, time_s);
    return mode_;
  }
  if (mode_ == LoopMode::HOLD || mode_ == LoopMode::RETRACT) {
    if (known && seen_in_a_row_ >= options_.resume_frames) {
      approaching_ = true;
      enter(LoopMode::RESUME, time_s);
    } else if (mode_ == LoopMode::HOLD && time_s - since_s_ > options_.hold_s && options_.retract_m > 0) {
      enter(LoopMode::RETRACT, time_s);
    }
    return mode_;
  }
  if (!known || unseen_s > options_.coast_s) {
    approaching_ = false;
    enter(LoopMode::HOLD, time_s);
  } else {
    if (seen && mode_ == LoopMode::COAST && time_s - since_s_ > kRejoin_s) approaching_ = true;
    enter(!seen ? LoopMode::COAST : approaching_ ? LoopMode::RESUME : LoopMode::FOLLOW, time_s);
  }
  return mode_;
}

void Supervisor::arrived() {
  approaching_ = false;
  if (mode_ == LoopMode::RESUME) mode_ = LoopMode::FOLLOW;
}

void Supervisor::lose(double time_s) {
  seen_in_a_row_ = 0;
  approaching_ = false;
  if (ever_followed_) enter(LoopMode::HOLD, time_s);
}

}  // namespace heartservo::servo
