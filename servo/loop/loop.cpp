#include "servo/loop/loop.hpp"

#include <cmath>

namespace heartservo::servo {

using tracking::TrackState;

Loop::Loop(tracking::FrameSource& frames, ToolRobot& robot, LoopStages stages, const LoopOptions& options,
           const Eigen::Vector3d& marker_to_tip_camera, std::function<double()> stopwatch)
    : frames_(frames),
      robot_(robot),
      stages_(std::move(stages)),
      options_(options),
      robot_data_(robot.data()),
      tip_estimator_(options.tip, robot_data_, marker_to_tip_camera),
      guard_(options.guard),
      stopwatch_(std::move(stopwatch)) {}

std::string Loop::start(const tracking::Quad& target_region, const tracking::Quad& marker_region) {
  if (!frames_.next(frame_)) return "there is no frame";
  const auto refined = [&](const auto& refine, const tracking::Quad& picked) {
    return refine && frame_.status == tracking::FrameStatus::OK ? refine(frame_, picked) : picked;
  };
  std::string why = stages_.target_tracker->start(frame_, refined(stages_.refine_target, target_region));
  if (!why.empty() || !stages_.marker_tracker) return why;
  why = stages_.marker_tracker->start(frame_, refined(stages_.refine_marker, marker_region));
  return why.empty() ? "" : "tool marker: " + why;
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
  record.chain_ms = 1e3 * (stopwatch_() - begin);
  return true;
}

void Loop::perceive(LoopRecord& record) {
  const double begin = stopwatch_();
  record.track = stages_.target_tracker->track(record.frame);
  if (stages_.marker_tracker) record.marker_track = stages_.marker_tracker->track(record.frame);
  record.track_ms = 1e3 * (stopwatch_() - begin);
  stages_.target_estimator->look_at(record.frame);
  record.target = stages_.target_estimator->estimate(record.track);
  if (stages_.marker_estimator) stages_.marker_estimator->look_at(record.frame);
  if (stages_.marker_estimator) record.marker = stages_.marker_estimator->estimate(record.marker_track);
  record.encoders = robot_.read(record.frame.time_s);
  record.tip = tip_estimator_.estimate(record.encoders, record.marker);
  if (stages_.ecg)
    stages_.ecg->advance(record.frame.time_s, [&](const RPeak& peak) {
      stages_.predictor->observe_beat(peak.time_s);
      record.r_peak_s = peak.time_s;
    });
  if (record.target.state == TrackState::LOST) return;
  record.goal_now = record.target.T_camera_target * options_.offset_m;
  MotionSample sample{record.frame.time_s, record.goal_now, record.target.position_covariance};
  if (record.target.state == TrackState::UNCERTAIN) sample.covariance *= 25;  // five times the standard deviation
  stages_.predictor->observe(sample);
  last_seen_s_ = record.frame.time_s;
  ever_seen_ = true;
}

void Loop::decide(LoopRecord& record) {
  const double time = record.frame.time_s, acts_at = time + options_.latency.total_s(),
               period = 1 / options_.frame_rate_hz;
  // The robot's own servo delays a slow motion by its lag: aim at where the goal will be then.
  const double then = acts_at + robot_data_.lag_s;
  record.goal_then = stages_.predictor->predict(then);
  if (record.target.state != TrackState::LOST)
    record.mode = LoopMode::FOLLOW;
  else
    record.mode = ever_seen_ && time - last_seen_s_ <= options_.guard.coast_s ? LoopMode::COAST : LoopMode::HOLD;
  if (!record.goal_then.valid) record.mode = LoopMode::HOLD;

  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
  if (record.mode != LoopMode::HOLD) {
    ControlState state;
    state.time_s = time;
    state.acts_at_s = acts_at;
    state.period_s = period;
    state.tip_now = record.tip;
    state.tip_then = record.tip + robot_data_.R_camera_base * history_.way_between(time - robot_data_.lag_s, acts_at);
    state.goal_now = record.goal_now;
    state.goal_then = record.goal_then;
    wanted = robot_data_.R_camera_base.transpose() * stages_.control_law->velocity(state);
  }
  record.guard = guard_.check(wanted, record.tip, period);
  record.command.acts_at_s = acts_at;
  record.command.velocity = record.guard.velocity;
  robot_.command(record.command);
  history_.add(acts_at, record.command.velocity);
  stop_reason_ = record.guard.stop;
}

}  // namespace heartservo::servo
