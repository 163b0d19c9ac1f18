#include "servo/safety/run_checks.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "servo/robot/robot_model.hpp"

namespace heartservo::servo {
namespace {

ToolRobotData robot_of(double bandwidth_hz) {
  ToolRobotData data;
  data.bandwidth_hz = bandwidth_hz;
  data.lag_s = bandwidth_hz > 0 ? 2 * 0.7 / (2 * M_PI * bandwidth_hz) : 0;
  return data;
}

// The loop itself, one axis, no noise: the ratio of the swing in the last fifth to that in the second.
double growth(double gain, double latency_s, double period_s, const ToolRobotData& robot) {
  RobotModel model(robot);
  std::vector<double> late, early;
  const int n = 1500;
  for (int k = 0; k < n; ++k) {
    const double t = k * period_s;
    model.advance_to(t);
    const double error = model.state().tip.x() - 0.001;
    model.command({t + latency_s, {-gain * error, 0, 0}});
    if (k > n / 5 && k < 2 * n / 5) early.push_back(std::abs(error));
    if (k > 4 * n / 5) late.push_back(std::abs(error));
  }
  return *std::max_element(late.begin(), late.end()) / *std::max_element(early.begin(), early.end());
}

TEST(RunChecks, TheLargestStableGainIsWhereTheLoopItselfTurnsUnstable) {
  for (const double bandwidth : {0.0, 12.0, 25.0})
    for (const double latency : {0.008, 0.024}) {
      const ToolRobotData robot = robot_of(bandwidth);
      const double most = largest_stable_gain(latency, 0.008, robot);
      EXPECT_LT(growth(0.97 * most, latency, 0.008, robot), 1) << bandwidth << " " << latency << " " << most;
      EXPECT_GT(growth(1.03 * most, latency, 0.008, robot), 1) << bandwidth << " " << latency << " " << most;
    }
}

std::string refused(const LoopOptions& options, const std::string& controller) {
  std::string all;
  for (const auto& reason : reasons_to_refuse(options, controller, robot_of(25))) all += reason + "\n";
  return all;
}

TEST(RunChecks, AcceptsTheDefaults) {
  for (const char* law : {"ibvs", "ibvs_feedforward"}) EXPECT_EQ(refused(LoopOptions{}, law), "");
}

TEST(RunChecks, RefusesAnUnstableGainForTheLawThatUsesIt) {
  LoopOptions options;
  options.control.gain = 60;
  EXPECT_NE(refused(options, "ibvs").find("loop.control.gain 60 /s is unstable"), std::string::npos);
  EXPECT_EQ(refused(options, "ibvs_feedforward"), "");
}

TEST(RunChecks, RefusesADelayThatNoPredictionBridges) {
  LoopOptions options;
  options.latency.set_total(0.4);
  EXPECT_NE(refused(options, "ibvs_feedforward").find("max_prediction_s"), std::string::npos);
}

TEST(RunChecks, RefusesAPathOutOfTheWorkspace) {
  LoopOptions options;
  options.path.type = "circle";
  options.path.size_m = 0.04;
  EXPECT_EQ(refused(options, "mpc"), "");
  options.guard.workspace_radius_m = 0.03;
  EXPECT_NE(refused(options, "mpc").find("loop.path reaches 40.0 mm"), std::string::npos);
  options.path.type = "file";
  options.path.file = "hand.csv";
  options.recorded_path = {{0, {0, 0, 0}}, {1, {0.05, 0, 0}}};
  EXPECT_NE(refused(options, "mpc").find("loop.path reaches 50.0 mm"), std::string::npos);
}

TEST(RunChecks, RefusesZeroLimitsAndAnOffsetOutsideTheWorkspace) {
  LoopOptions options;
  options.guard.max_speed = 0;
  options.offset_m = {0.06, 0, 0};
  const std::string all = refused(options, "ibvs_feedforward");
  EXPECT_NE(all.find("max_speed"), std::string::npos) << all;
  EXPECT_NE(all.find("offset_m"), std::string::npos) << all;
}

}  // namespace
}  // namespace heartservo::servo
