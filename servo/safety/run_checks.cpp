#include "servo/safety/run_checks.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>

#include "servo/robot/robot_model.hpp"

namespace heartservo::servo {

namespace {

using Complex = std::complex<double>;

// One axis of the robot over one period: x = (tip, its velocity, reference), driven by the command before during the
// first part of the period and by the new one during the rest.
struct SampledRobot {
  Eigen::Matrix3d A;
  Eigen::Vector3d B_before, B_new;
  int whole_periods;  // of latency
  double period_s;

  SampledRobot(double latency_s, double period, const ToolRobotData& robot) : period_s(period) {
    whole_periods = static_cast<int>(latency_s / period + 1e-9);
    const double part = std::max(0.0, latency_s - whole_periods * period);
    ToolRobotData linear = robot;
    linear.max_speed = linear.max_acceleration = 0;
    const RobotModel model(linear);
    const auto run = [&](Eigen::Vector3d x, double before, double fresh) {
      RobotState s;
      s.tip.x() = x[0], s.tip_velocity.x() = x[1], s.reference.x() = x[2];
      constexpr int kSteps = 16;
      for (int i = 0; i < kSteps && part > 0; ++i) model.step(s, {before, 0, 0}, part / kSteps);
      for (int i = 0; i < kSteps; ++i) model.step(s, {fresh, 0, 0}, (period - part) / kSteps);
      return Eigen::Vector3d(s.tip.x(), s.tip_velocity.x(), s.reference.x());
    };
    for (int i = 0; i < 3; ++i) A.col(i) = run(Eigen::Vector3d::Unit(i), 0, 0);
    B_before = run(Eigen::Vector3d::Zero(), 1, 0);
    B_new = run(Eigen::Vector3d::Zero(), 0, 1);
  }

  // Tip per command at the frequency w.
  Complex response(double w) const {
    const Complex z = std::polar(1.0, w * period_s);
    const Eigen::Matrix3cd M = z * Eigen::Matrix3cd::Identity() - A.cast<Complex>();
    const Eigen::Vector3cd b = B_new.cast<Complex>() + B_before.cast<Complex>() / z;
    return std::polar(1.0, -w * period_s * whole_periods) * (M.inverse() * b)[0];
  }
};

}  // namespace

double largest_stable_gain(double latency_s, double period_s, const ToolRobotData& robot) {
  const SampledRobot sampled(latency_s, period_s, robot);
  // The phase falls from the integrator's -90 degrees: follow it to -180.
  const double last = std::numbers::pi / period_s, step = last / 4000;
  double phase = -std::numbers::pi / 2, low = step;
  for (double w = step; w < last; w += step) {
    const double next = std::arg(sampled.response(w));
    const double turn = std::remainder(next - phase, 2 * std::numbers::pi);
    if (phase + turn <= -std::numbers::pi) break;
    phase += turn;
    low = w;
  }
  double high = std::min(low + step, last);
  for (int i = 0; i < 40; ++i) {
    const double w = 0.5 * (low + high);
    const double turn = std::remainder(std::arg(sampled.response(w)) - phase, 2 * std::numbers::pi);
    (phase + turn > -std::numbers::pi ? low : high) = w;
  }
  return 1 / std::abs(sampled.response(low));
}

std::vector<std::string> reasons_to_refuse(const LoopOptions& options, const std::string& controller,
                                           const ToolRobotData& robot) {
  std::vector<std::string> reasons = options.validate();
  const double latency = options.latency.total_s(), period = 1 / options.frame_rate_hz;
  if (controller == "ibvs") {
    const double most = largest_stable_gain(latency, period, robot);
    if (options.control.gain >= most)
      reasons.push_back(
          fmt::format("loop.control.gain {:.3g} /s is unstable: with {:.0f} ms of latency, a period of {:.0f} ms and "
                      "this robot the "
                      "loop oscillates from {:.3g} /s on; take half of that or less",
                      options.control.gain, 1e3 * latency, 1e3 * period, most));
  }
  const double ahead = latency + robot.lag_s + period;
  if (ahead > options.guard.max_prediction_s)
    reasons.push_back(
        fmt::format("loop.latency: a command must foresee {:.0f} ms (latency {:.0f}, robot {:.0f}, period {:.0f}), but "
                    "predictions are trusted for loop.guard.max_prediction_s {:.0f} ms only",
                    1e3 * ahead, 1e3 * latency, 1e3 * robot.lag_s, 1e3 * period, 1e3 * options.guard.max_prediction_s));
  if (options.offset_m.norm() >= options.guard.workspace_radius_m)
    reasons.push_back("loop.offset_m lies outside loop.guard.workspace_radius_m");
  if (options.force.on()) {
    const double loop_gain = options.force.gain * options.force.stiffest_n_m;
    const double most = largest_stable_gain(latency + period, period, robot);
    if (loop_gain >= most)
      reasons.push_back(
          fmt::format("loop.force.gain {:.3g} m/s/N is unstable on tissue of loop.force.stiffest_n_m {:.0f} N/m: their "
                      "product is {:.3g} /s, and the loop oscillates from {:.3g} /s on",
                      options.force.gain, options.force.stiffest_n_m, loop_gain, most));
    if (options.force.wanted_n >= options.guard.max_force_n)
      reasons.push_back("loop.force.wanted_n is not below loop.guard.max_force_n");
  }
  if (const double reach = SurgeonPath(options.path, options.recorded_path).reach_m();
      reach > options.guard.workspace_radius_m)
    reasons.push_back(
        fmt::format("loop.path reaches {:.1f} mm from its start, out of loop.guard.workspace_radius_m ({:.1f} mm)",
                    1e3 * reach, 1e3 * options.guard.workspace_radius_m));
  return reasons;
}

}  // namespace heartservo::servo
