#include "servo/loop/loop.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "servo/control/feed_forward.hpp"

namespace heartservo::servo {

using tracking::TrackState;

Loop::Loop(tracking::FrameSource& frames, ToolRobot& robot, LoopStages stages, const LoopOptions& options,
           const Eigen::Vector3d& marker_to_tip_camera, std::function<double()> stopwatch)
    : frames_(frames),
      robot_(robot),
      stages_(std::move(stages)),
      options_(options),
      robot_data_(robot.data()),
      lag_(robot_data_),
      model_(robot_data_),
      tip_estimator_(options.tip, robot_data_, marker_to_tip_camera),
      path_(options.path, options.recorded_path),
      force_(options.force),
      filter_(options.control.filter_hz),
      supervisor_(options.guard, 1 / options.frame_rate_hz),
      retreat_(options.guard, options.tool_axis),
      watchdog_(options.guard),
      guard_(options.guard),
      stopwatch_(std::move(stopwatch)) {}

const tracking::Frame* Loop::first_frame() {
  if (!any_frame_) any_frame_ = frames_.next(frame_);
  return any_frame_ ? &frame_ : nullptr;
}

tracking::Quad Loop::refined(const std::function<tracking::Quad(const tracking::Frame&, const tracking::Quad&)>& refine,
                             const tracking::Quad& picked) const {
  return refine && frame_.status == tracking::FrameStatus::OK ? refine(frame_, picked) : picked;
}

std::string Loop::start(const tracking::Quad& target_region, const tracking::Quad& marker_region) {
  if (!first_frame()) return "there is no frame";
  std::string why = stages_.target_tracker->start(frame_, refined(stages_.refine_target, target_region));
  if (!why.empty() || !stages_.marker_tracker) return why;
  why = stages_.marker_tracker->start(frame_, refined(stages_.refine_marker, marker_region));
  return why.empty() ? "" : "tool marker: " + why;
}

std::string Loop::restart(LoopStages fresh, const tracking::Quad& region) {
  if (frame_.status != tracking::FrameStatus::OK) return "this frame shows nothing to learn";
  std::string why = fresh.target_tracker->start(frame_, refined(fresh.refine_target, region));
  if (!why.empty()) return why;
  stages_.target_tracker = std::move(fresh.target_tracker);
  stages_.target_estimator = std::move(fresh.target_estimator);
  stages_.predictor = std::move(fresh.predictor);
  stages_.refine_target = std::move(fresh.refine_target);
  seen_goals_.setEmpty();
  ever_seen_ = false;
  watchdog_.forget_target();
  supervisor_.lose(frame_.time_s);
  return "";
}

bool Loop::step(LoopRecord& record) {
  if (!stop_reason_.empty()) return false;
  if (!first_ && !frames_.next(frame_)) return false;
  first_ = false;
  record = LoopRecord{};
  record.frame = frame_;
  const double begin = stopwatch_();
  perceive(record);
  decide(record);
  if (stages_.frame_clock) record.glass_to_command_s = stages_.frame_clock() - frame_.time_s;
  const double chain_s = stopwatch_() - begin;
  record.chain_ms = 1e3 * chain_s;
  if (stop_reason_.empty()) stop_reason_ = watchdog_.computing_time(chain_s);
  return true;
}

void Loop::perceive(LoopRecord& record) {
  const double begin = stopwatch_(), time = record.frame.time_s, period = 1 / options_.frame_rate_hz;
  if (stages_.frame_clock) record.age_s = stages_.frame_clock() - time;
  record.stale = !watchdog_.is_fresh(time, record.age_s);
  record.track = stages_.target_tracker->track(record.frame);
  if (stages_.marker_tracker) record.marker_track = stages_.marker_tracker->track(record.frame);
  record.track_ms = 1e3 * (stopwatch_() - begin);
  stages_.target_estimator->look_at(record.frame);
  record.target = stages_.target_estimator->estimate(record.track);
  if (stages_.marker_estimator) stages_.marker_estimator->look_at(record.frame);
  if (stages_.marker_estimator) record.marker = stages_.marker_estimator->estimate(record.marker_track);
  record.encoders = robot_.read(time);
  record.tip = tip_of(record);
  if (stages_.ecg)
    stages_.ecg->advance(time, [&](const RPeak& peak) {
      stages_.predictor->observe_beat(peak.time_s);
      record.r_peak_s = peak.time_s;
    });
  bool seen = !record.stale && record.target.state != TrackState::LOST;
  if (seen) {
    Eigen::Vector3d goal = record.target.T_camera_target * options_.offset_m;
    if (options_.eye_in_hand) goal += record.tip - view_;
    record.implausible = !watchdog_.is_plausible(time, goal, period);
    seen = !record.implausible;
    if (seen) {
      turn_to(record.target.T_camera_target.linear());
      record.carried = goal;
      record.goal_now = goal + R_camera_target_ * (path_.position(time) + Eigen::Vector3d(0, 0, force_.depth(time)));
    }
  }
  if (seen) {
    MotionSample sample{time, record.carried, record.target.position_covariance};
    if (record.target.state == TrackState::UNCERTAIN) sample.covariance *= 25;  // five times the standard deviation
    stages_.predictor->observe(sample);
    seen_goals_.extend(record.carried);
  }
  record.mode = supervisor_.update(time, seen, seen ? stages_.predictor->predict(time).valid : may_coast(time));
  record.depth_m = force_.depth(time);
  force_.update(time, record.encoders.force_n, period, record.mode == LoopMode::FOLLOW);
  record.force_wanted_n = force_.phase() == ForcePhase::PRESS ? options_.force.wanted_n : 0;
}

// A polynomial leads further and further away; a heart comes back to where it was.
bool Loop::may_coast(double time_s) const {
  const Prediction goal = stages_.predictor->predict(time_s + options_.latency.total_s() + robot_data_.lag_s);
  return goal.valid && seen_goals_.exteriorDistance(goal.position) <= options_.guard.coast_beyond_m;
}

// The tip in the camera frame. Eye-in-hand the camera frame is that of the first picture, and the "tip" the place at
// which the camera shows view_, which is to stay on the goal: encoders enter tip and goal alike, so that an error of
// their calibration cancels.
Eigen::Vector3d Loop::tip_of(const LoopRecord& record) {
  if (!options_.eye_in_hand) return tip_estimator_.estimate(record.encoders, record.marker);
  const Eigen::Vector3d by_encoders = robot_data_.R_camera_base * record.encoders.tip;
  if (!view_.allFinite()) {
    encoders_start_ = by_encoders;
    if (record.target.state != TrackState::LOST) view_ = record.target.T_camera_target * options_.offset_m;
  }
  return by_encoders - encoders_start_ + (view_.allFinite() ? view_ : Eigen::Vector3d::Zero());
}

// The target's orientation, over about 40 ms: it only carries the surgeon's path, and one frame's is noisy.
void Loop::turn_to(const Eigen::Matrix3d& R_camera_target) {
  const double share = ever_seen_ ? 1 - std::exp(-1 / (0.04 * options_.frame_rate_hz)) : 1;
  const Eigen::Quaterniond before(R_camera_target_), now(R_camera_target);
  R_camera_target_ = before.slerp(share, now).toRotationMatrix();
  ever_seen_ = true;
}

// What the surgeon's path adds at a time, and what is left of the way to the goal after an interruption.
Eigen::Vector3d Loop::shift_at(double time_s) const {
  const double depth = std::max(0.0, force_.depth(time_s));  // far ahead its rate would lead beyond the offset
  return R_camera_target_ * (path_.position(time_s) + Eigen::Vector3d(0, 0, depth)) + retreat_.offset(time_s);
}

// The goal at a time: where the heart will carry the offset, shifted.
Prediction Loop::goal_at(double time_s) const {
  Prediction goal = stages_.predictor->predict(time_s);
  goal.position += shift_at(time_s);
  goal.velocity += R_camera_target_ * (path_.velocity(time_s) + Eigen::Vector3d(0, 0, force_.rate())) +
                   retreat_.offset_rate(time_s);
  return goal;
}

// law -> feed-forward -> filter, in the camera frame.
Eigen::Vector3d Loop::wanted(LoopRecord& record, double acts_at) {
  const double period = 1 / options_.frame_rate_hz;
  const Eigen::Matrix3d R = tip_estimator_.R_camera_base();
  model_.advance_to(record.frame.time_s);
  const RobotState now = model_.state(), then = model_.at(acts_at);
  ControlState state;
  state.time_s = record.frame.time_s;
  state.acts_at_s = acts_at;
  state.period_s = period;
  state.tip_now = record.tip;
  state.goal_now = record.carried;
  state.last_velocity = last_velocity_;
  state.robot = {record.tip + R * (then.reference - now.tip), R * then.reference_velocity,
                 record.tip + R * (then.tip - now.tip), R * then.tip_velocity};
  if (record.mode == LoopMode::RESUME && supervisor_.since_s() == record.frame.time_s)
    retreat_.approach(acts_at, state.robot.tip - goal_at(acts_at).position);
  record.goal_then = goal_at(acts_at + robot_data_.lag_s);
  state.goal_then = record.goal_then;
  if (record.mode == LoopMode::FOLLOW) retreat_.remember(record.tip);
  if (record.mode == LoopMode::RESUME && retreat_.arrived(acts_at)) supervisor_.arrived();
  if (!supervisor_.ever_followed()) return Eigen::Vector3d::Zero();
  if (record.mode == LoopMode::HOLD || record.mode == LoopMode::RETRACT)
    return retreat_.velocity(record.mode, record.frame.time_s - supervisor_.since_s(), state.robot.reference);

  ControlLaw& law = *stages_.control_law;
  for (int k = -1; k <= law.horizon(); ++k) {
    const auto i = static_cast<std::size_t>(k + 1);
    state.goals[i] = goal_at(acts_at + k * period);
    state.shifts[i] = shift_at(acts_at + k * period);
  }
  Eigen::Vector3d v = law.velocity(state);
  if (law.wants_feed_forward()) v += feed_forward(state, lag_);
  return filter_.next(v, period);
}

void Loop::decide(LoopRecord& record) {
  const double acts_at = record.frame.time_s + options_.latency.total_s(), period = 1 / options_.frame_rate_hz;
  const Eigen::Vector3d v = wanted(record, acts_at);
  const bool sees_error = record.mode == LoopMode::FOLLOW && record.goal_now.allFinite();
  GuardView view;
  view.tip = record.tip;
  view.error_m = sees_error ? (record.tip - record.goal_now).norm() : 0;
  view.force_n = record.encoders.force_n;
  record.guard = guard_.check(v, view, period);  // limits -> finite check
  last_velocity_ = record.guard.velocity;
  record.command.acts_at_s = acts_at;
  record.command.expires_at_s = acts_at + std::max(options_.guard.command_life_s, 1.5 * period);
  record.command.velocity = tip_estimator_.R_camera_base().transpose() * last_velocity_;
  robot_.command(record.command);
  model_.command(record.command);
  stop_reason_ = record.guard.stop;
}

}  // namespace heartservo::servo
