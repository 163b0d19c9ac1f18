#include "servo/safety/retreat.hpp"

#include <algorithm>

namespace heartservo::servo {

namespace {

constexpr double kGain = 6;  // 1/s: slow enough for any delay the loop accepts

}  // namespace

Eigen::Vector3d Retreat::velocity(LoopMode mode, double mode_s, const Eigen::Vector3d& tip) const {
  Eigen::Vector3d place = safe_place_, ahead = Eigen::Vector3d::Zero();
  if (mode == LoopMode::RETRACT) {
    const double way = std::min(options_.retract_m, options_.retract_speed * std::max(0.0, mode_s));
    place += way * axis_;
    if (way < options_.retract_m) ahead = options_.retract_speed * axis_;
  }
  Eigen::Vector3d v = kGain * (place - tip) + ahead;
  if (const double speed = v.norm(); speed > options_.retract_speed) v *= options_.retract_speed / speed;
  return v;
}

void Retreat::approach(double time_s, const Eigen::Vector3d& offset) {
  begin_s_ = time_s;
  offset_ = offset;
  duration_s_ = 1.5 * offset.norm() / options_.approach_speed;  // the fastest moment of 3 x^2 - 2 x^3 has slope 1.5
}

Eigen::Vector3d Retreat::offset(double time_s) const {
  if (arrived(time_s)) return Eigen::Vector3d::Zero();
  const double x = std::max(0.0, (time_s - begin_s_) / duration_s_);
  return offset_ * (1 - x * x * (3 - 2 * x));
}

Eigen::Vector3d Retreat::offset_rate(double time_s) const {
  if (arrived(time_s) || time_s < begin_s_) return Eigen::Vector3d::Zero();
  const double x = (time_s - begin_s_) / duration_s_;
  return offset_ * (-6 * x * (1 - x) / duration_s_);
}

}  // namespace heartservo::servo
