#include "servo/control/force_loop.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::servo {

void ForceLoop::update(double time_s, double force_n, double period_s, bool follows) {
  depth_ = std::clamp(depth_ + rate_ * period_s, 0.0, options_.max_depth_m);
  time_s_ = time_s;
  rate_ = 0;
  if (!options_.on()) return;
  const bool wanted = follows && time_s >= options_.start_s && time_s < options_.end_s && std::isfinite(force_n);
  switch (phase_) {
    case ForcePhase::FREE:
      if (wanted) phase_ = ForcePhase::APPROACH;
      break;
    case ForcePhase::APPROACH:
      if (force_n > options_.touch_n) phase_ = ForcePhase::PRESS;
      break;
    case ForcePhase::PRESS:
      break;
    case ForcePhase::RELEASE:
      if (depth_ <= 0) phase_ = wanted ? ForcePhase::APPROACH : ForcePhase::FREE;
      break;
  }
  if (!wanted && phase_ != ForcePhase::FREE) phase_ = ForcePhase::RELEASE;
  if (phase_ == ForcePhase::APPROACH) rate_ = options_.approach_speed;
  // Never faster than the touch was approached: a lost touch is no reason to hit the tissue.
  if (phase_ == ForcePhase::PRESS)
    rate_ = std::clamp(options_.gain * (options_.wanted_n - force_n), -options_.release_speed, options_.approach_speed);
  if (phase_ == ForcePhase::RELEASE) rate_ = -options_.release_speed;
  // not beyond the ends of the way
  rate_ = std::clamp(rate_, -depth_ / period_s, (options_.max_depth_m - depth_) / period_s);
}

}  // namespace heartservo::servo
