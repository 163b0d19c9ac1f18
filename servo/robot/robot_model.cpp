#include "servo/robot/robot_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace heartservo::servo {

namespace {

constexpr double kStep_s = 5e-4;

// omega and zeta: as stated, or those of a critically damped servo with the stated lag.
std::pair<double, double> dynamics_of(const ToolRobotData& data) {
  if (data.bandwidth_hz > 0) return {2 * std::numbers::pi * data.bandwidth_hz, data.damping};
  return {data.lag_s > 0 ? 2 / data.lag_s : 0, 1};
}

}  // namespace

RobotLag::RobotLag(const ToolRobotData& data) {
  const auto [w, zeta] = dynamics_of(data);
  if (w > 0) lag_s = 2 * zeta / w, lag2_s2 = 1 / (w * w);
}

RobotModel::RobotModel(const ToolRobotData& data)
    : max_speed_(data.max_speed > 0 ? data.max_speed : 1e9),
      max_acceleration_(data.max_acceleration > 0 ? data.max_acceleration : 1e9) {
  std::tie(w_, damping_) = dynamics_of(data);
}

void RobotModel::command(const ToolCommand& command) {
  queue_[given_ % queue_.size()] = command;
  ++given_;
}

void RobotModel::step(RobotState& s, const Eigen::Vector3d& commanded, double dt) const {
  Eigen::Vector3d target = commanded;
  if (const double speed = target.norm(); speed > max_speed_) target *= max_speed_ / speed;
  Eigen::Vector3d change = target - s.reference_velocity;
  const double length = change.norm(), longest = max_acceleration_ * dt;
  if (length > longest) change *= longest / length;
  // The ramp ends within the step where the change is small: its mean velocity over the step.
  const double ramp = length > longest ? 1 : length / std::max(longest, 1e-300);
  const Eigen::Vector3d way = dt * (s.reference_velocity + change * (1 - 0.5 * ramp));
  s.reference_velocity += change;
  if (w_ <= 0) {
    s.reference += way;
    s.tip = s.reference;
    s.tip_velocity = s.reference_velocity;
    return;
  }
  const Eigen::Vector3d r0 = s.reference, r1 = r0 + way;
  const auto acceleration = [&](const Eigen::Vector3d& r, const Eigen::Vector3d& p, const Eigen::Vector3d& v) {
    return Eigen::Vector3d(w_ * w_ * (r - p) - 2 * damping_ * w_ * v);
  };
  // Heun's method twice would do; the classical Runge-Kutta step costs the same here and is exact to 1e-9 m.
  const Eigen::Vector3d p = s.tip, v = s.tip_velocity, rm = 0.5 * (r0 + r1);
  const Eigen::Vector3d a1 = acceleration(r0, p, v), v2 = v + 0.5 * dt * a1;
  const Eigen::Vector3d a2 = acceleration(rm, p + 0.5 * dt * v, v2), v3 = v + 0.5 * dt * a2;
  const Eigen::Vector3d a3 = acceleration(rm, p + 0.5 * dt * v2, v3), v4 = v + dt * a3;
  const Eigen::Vector3d a4 = acceleration(r1, p + dt * v3, v4);
  s.tip = p + dt / 6 * (v + 2 * v2 + 2 * v3 + v4);
  s.tip_velocity = v + dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  s.reference = r1;
}

Eigen::Vector3d RobotModel::commanded_at(double time_s, std::size_t& taken) const {
  while (taken < given_ && queue_[taken % queue_.size()].acts_at_s <= time_s + 1e-9) ++taken;
  if (taken == 0) return Eigen::Vector3d::Zero();
  const ToolCommand& last = queue_[(taken - 1) % queue_.size()];
  return time_s + 1e-9 < last.expires_at_s ? last.velocity : Eigen::Vector3d::Zero();
}

double RobotModel::run(RobotState& state, double from_s, double to_s, std::size_t& taken) const {
  double t = from_s;
  while (t < to_s - 1e-12) {
    const Eigen::Vector3d commanded = commanded_at(t, taken);
    double end = std::min(t + kStep_s, to_s);
    if (taken < given_) end = std::min(end, std::max(queue_[taken % queue_.size()].acts_at_s, t + 1e-9));
    step(state, commanded, end - t);
    t = end;
  }
  return to_s;
}

void RobotModel::advance_to(double time_s) {
  if (time_s > time_s_) time_s_ = run(state_, time_s_, time_s, taken_);
}

RobotState RobotModel::at(double time_s) const {
  RobotState state = state_;
  std::size_t taken = taken_;
  run(state, time_s_, time_s, taken);
  return state;
}

}  // namespace heartservo::servo
