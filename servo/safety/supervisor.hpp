#pragma once
// Decides from frame to frame whether the tool follows, coasts, holds, retracts or resumes (loop_mode.hpp):
//
//   FOLLOW <-> COAST -> HOLD -> RETRACT        after coast_s and hold_s without a target that is seen and believed
//      ^                  |        |
//      +---- RESUME <-----+--------+           after resume_frames frames in a row with one; after a coast of more than
//                                              0.05 s at once
#include <algorithm>

#include "servo/safety/guard_options.hpp"
#include "servo/safety/loop_mode.hpp"

namespace heartservo::servo {

class Supervisor {
 public:
  /// `period_s`: of the frames; a coast never ends between two of them.
  Supervisor(const GuardOptions& options, double period_s) : options_(options) {
    options_.coast_s = std::max(options_.coast_s, 1.5 * period_s);
  }

  /// Once a frame, with increasing times. `seen`: the target is seen in this frame and believed; `known`: there is a
  /// prediction.
  LoopMode update(double time_s, bool seen, bool known);

  /// Call it when the approach of RESUME has come to its end.
  void arrived();

  /// The target is another one now, which has not been seen yet: HOLD.
  void lose(double time_s);

  LoopMode mode() const { return mode_; }
  /// When the present mode began, s.
  double since_s() const { return since_s_; }
  /// False until the target has been followed for the first time.
  bool ever_followed() const { return ever_followed_; }

 private:
  void enter(LoopMode mode, double time_s);

  GuardOptions options_;
  LoopMode mode_ = LoopMode::HOLD;
  double since_s_ = 0, last_seen_s_ = 0;
  int seen_in_a_row_ = 0;
  bool ever_followed_ = false, approaching_ = false;
};

}  // namespace heartservo::servo
