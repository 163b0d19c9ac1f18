#pragma once
// A robot whose tool feels the tissue: passes everything on and adds what the force sensor says.
#include <functional>
#include <random>

#include "servo/robot/tool_robot.hpp"

namespace heartservo::sim {

class FeelingRobot final : public servo::ToolRobot {
 public:
  /// `force`: the true contact force at a time, N.
  FeelingRobot(servo::ToolRobot& robot, std::function<double(double time_s)> force, double noise_n, std::uint64_t seed)
      : robot_(robot), force_(std::move(force)), noise_n_(noise_n), random_(seed) {}

  servo::ToolRobotData data() const override { return robot_.data(); }
  void command(const servo::ToolCommand& command) override { robot_.command(command); }
  servo::ToolState read(double time_s) override {
    servo::ToolState state = robot_.read(time_s);
    state.force_n = force_(time_s) + noise_n_ * normal_(random_);
    return state;
  }

 private:
  servo::ToolRobot& robot_;
  std::function<double(double)> force_;
  double noise_n_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0, 1};
};

}  // namespace heartservo::sim
