#pragma once
// Pressing on tissue with a wanted force while it moves: an admittance along the tissue's normal, on top of the motion
// that the position loop cancels (Yuen, Perrin, Vasilyev, del Nido, Howe: Force tracking with feed-forward motion
// estimation for beating heart surgery, IEEE T-RO 2010). The tip's depth from the wanted offset moves by
//
//   d' = gain (f_wanted - f),
//
// so that tissue of stiffness k closes the loop with gain k / s: stable while gain k is below largest_stable_gain().
// The heart's own motion is fed forward by the goal, which the depth is added to.
//
//   FREE -> APPROACH (approach_speed, until touched) -> PRESS -> RELEASE (back to the offset) -> FREE
#include "tracking/settings/fields.hpp"

namespace heartservo::servo {

struct ForceOptions {
  double wanted_n = 0;
  double gain = 0.02;
  double touch_n = 0.06;
  double approach_speed = 0.004;
  double release_speed = 0.02;
  double start_s = 4, end_s = 1e5;
  double max_depth_m = 0.01;
  double stiffest_n_m = 1000;

  bool on() const { return wanted_n > 0; }

  void fields(FieldVisitor& v) {
    v.field({"wanted_n", "N", "force with which the tip presses along the tissue's normal; 0: no force loop", 0, 50},
            wanted_n);
    v.field({"gain", "m/s/N", "speed of the depth per missing force", 1e-5, 1}, gain);
    v.field({"touch_n", "N", "force at which the tip is taken to touch; well above the sensor's noise", 1e-3, 10},
            touch_n);
    v.field({"approach_speed", "m/s", "towards the tissue until it is touched", 1e-4, 0.1}, approach_speed);
    v.field({"release_speed", "m/s", "away from the tissue at the end", 1e-4, 0.2}, release_speed);
    v.field({"start_s", "s", "when the approach begins", 0, 1e5}, start_s);
    v.field({"end_s", "s", "when the tip lets go", 0, 1e5}, end_s);
    v.field({"max_depth_m", "m", "the tip goes no deeper than this from its offset", 1e-4, 0.05}, max_depth_m);
    v.field({"stiffest_n_m", "N/m", "stiffest tissue for which the loop must be stable, else the run is refused", 1,
             1e6},
            stiffest_n_m);
  }
};

enum class ForcePhase { FREE, APPROACH, PRESS, RELEASE };

class ForceLoop {
 public:
  explicit ForceLoop(const ForceOptions& options) : options_(options) {}

  /// Once a frame. `force_n`: felt; `follows`: the target is followed, else the tip lets go.
  void update(double time_s, double force_n, double period_s, bool follows);

  /// Depth (m, into the tissue from the wanted offset) at a time near the last update.
  double depth(double time_s) const { return depth_ + rate_ * (time_s - time_s_); }
  double rate() const { return rate_; }
  ForcePhase phase() const { return phase_; }

 private:
  ForceOptions options_;
  ForcePhase phase_ = ForcePhase::FREE;
  double time_s_ = 0, depth_ = 0, rate_ = 0;
};

}  // namespace heartservo::servo
