#pragma once
// What all simulated robots do alike with velocity commands of the tip: each waits for its time, holds until the next
// acts or it expires, and is approached no faster than the drives accelerate.
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

#include "servo/robot/tool_robot.hpp"

namespace heartservo::sim {

class TipDrive {
 public:
  /// m/s, m/s^2; an acceleration of INFINITY follows at once.
  TipDrive(double max_speed, double max_acceleration) : max_speed_(max_speed), max_acceleration_(max_acceleration) {}

  void command(const servo::ToolCommand& command) {
    queue_[given_ % queue_.size()] = command;
    ++given_;
  }

  /// Takes what acts within half of `dt` of `time_s`, and gives the velocity that the drives reach in a step of `dt`.
  const Eigen::Vector3d& step(double time_s, double dt) {
    take(time_s + 0.5 * dt);
    Eigen::Vector3d change = (time_s > expires_s_ ? Eigen::Vector3d::Zero() : commanded_) - velocity_;
    const double length = change.norm(), longest = max_acceleration_ * dt;
    if (length > longest) change *= longest / length;
    velocity_ += change;
    return velocity_;
  }

 private:
  void take(double until_s) {
    for (; taken_ < given_ && queue_[taken_ % queue_.size()].acts_at_s <= until_s; ++taken_) {
      const servo::ToolCommand& next = queue_[taken_ % queue_.size()];
      commanded_ = next.velocity;
      expires_s_ = next.expires_at_s;
      if (const double speed = commanded_.norm(); speed > max_speed_) commanded_ *= max_speed_ / speed;
    }
  }

  double max_speed_, max_acceleration_, expires_s_ = INFINITY;
  Eigen::Vector3d commanded_ = Eigen::Vector3d::Zero(), velocity_ = Eigen::Vector3d::Zero();
  std::array<servo::ToolCommand, 256> queue_{};
  std::size_t given_ = 0, taken_ = 0;
};

}  // namespace heartservo::sim
