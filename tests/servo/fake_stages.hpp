#pragma once
// A loop on stages made of one line each.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "servo/loop/loop.hpp"

namespace heartservo::test {

inline constexpr double kFakePeriod = 0.01;  // s
inline constexpr double kFakeSpeed = 0.02;   // m/s, of the target along x

/// Empty frames at 100 Hz. From frame `gap_at` on they come `gap_s` later; frame `repeated` repeats the time before.
struct FakeFrames final : tracking::FrameSource {
  std::size_t count, at = 0, gap_at = SIZE_MAX, repeated = SIZE_MAX;
  double gap_s = 0;
  explicit FakeFrames(std::size_t n) : count(n) {}
  bool next(tracking::Frame& frame) override {
    if (at == count) return false;
    frame = tracking::Frame{};
    frame.time_s = kFakePeriod * static_cast<double>(at == repeated ? at - 1 : at) + (at >= gap_at ? gap_s : 0);
    frame.sequence = at++;
    return true;
  }
  cv::Size size() const override { return {1, 1}; }
  double frame_rate_hz() const override { return 1 / kFakePeriod; }
  std::optional<std::size_t> frame_count() const override { return count; }
  std::string description() const override { return "fake"; }
};

/// Follows its commands at once; feels `force_n`.
struct FakeRobot final : servo::ToolRobot {
  std::vector<servo::ToolCommand> commands;
  servo::RobotModel model{servo::ToolRobotData{}};
  const Eigen::Vector3d start{0, 0, 0.05};
  double force_n = 0;
  servo::ToolRobotData data() const override { return {}; }
  servo::ToolState read(double t) override {
    model.advance_to(t);
    servo::ToolState state;
    state.time_s = t;
    state.tip = start + model.state().tip;
    state.force_n = force_n;
    return state;
  }
  void command(const servo::ToolCommand& c) override {
    commands.push_back(c);
    model.command(c);
  }
};

/// Sees the target everywhere but in frames [lost_from, lost_to).
struct FakeTracker final : tracking::TargetTracker {
  std::uint64_t lost_from = 100000, lost_to = 100000;
  std::string refusal;
  std::string start(const tracking::Frame&, const tracking::Quad&) override { return refusal; }
  tracking::Track track(const tracking::Frame& frame) override {
    tracking::Track track;
    track.time_s = frame.time_s;
    const bool lost = frame.sequence >= lost_from && frame.sequence < lost_to;
    track.state = lost ? tracking::TrackState::LOST : tracking::TrackState::OK;
    return track;
  }
  Eigen::Vector2d carry(const Eigen::Vector2d& start_px) const override { return start_px; }
  void mark_left_out(cv::Mat&) override {}
};

/// The target moves along x at kFakeSpeed. It seems to be 20 mm off in the frame at `jump_at_s`, and is `offset` away from
/// `offset_after_s` on.
struct FakeEstimator final : tracking::TargetEstimator {
  double jump_at_s = -1, offset_after_s = 1e9;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  tracking::TargetState estimate(const tracking::Track& track) override {
    tracking::TargetState state;
    state.time_s = track.time_s;
    state.state = track.state;
    const double jump = std::abs(track.time_s - jump_at_s) < 1e-9 ? 0.02 : 0;
    state.T_camera_target.translation() = Eigen::Vector3d(kFakeSpeed * track.time_s + jump, 0, 0.05);
    if (track.time_s > offset_after_s - 1e-9) state.T_camera_target.translation() += offset;
    return state;
  }
};

/// Remembers what it saw; answers `answer`.
struct FakeLaw final : servo::ControlLaw {
  std::vector<servo::ControlState>* seen;
  Eigen::Vector3d answer;
  FakeLaw(std::vector<servo::ControlState>* s, Eigen::Vector3d a) : seen(s), answer(std::move(a)) {}
  Eigen::Vector3d velocity(const servo::ControlState& state) override {
    seen->push_back(state);
    return answer;
  }
};

/// Beats once a second from -4 s on; remembers how far it was asked to look.
struct FakeEcg final : servo::EcgSource {
  std::vector<double>* asked;
  long at = -9 * 125;
  explicit FakeEcg(std::vector<double>* a) : asked(a) {}
  double rate_hz() const override { return 250; }
  bool next(double until_s, servo::EcgSample& sample) override {
    if (asked->empty() || until_s > asked->back()) asked->push_back(until_s);
    const double t = static_cast<double>(at) / 250, since = t - std::round(t);
    if (t > until_s) return false;
    sample = {t, std::exp(-0.5 * since * since / 1e-4)};
    ++at;
    return true;
  }
};

/// Remembers the beats it was told; foresees nothing.
struct FakePredictor final : servo::MotionPredictor {
  std::vector<double>* beats;
  explicit FakePredictor(std::vector<double>* b) : beats(b) {}
  void observe(const servo::MotionSample&) override {}
  void observe_beat(double r_peak_s) override { beats->push_back(r_peak_s); }
  servo::Prediction predict(double) const override { return {}; }
};

/// Set what you like, then run().
struct FakeBench {
  FakeFrames frames;
  FakeRobot robot;
  servo::LoopStages stages;
  FakeTracker* tracker = nullptr;
  FakeEstimator* estimator = nullptr;
  std::vector<servo::ControlState> seen;
  servo::LoopOptions options;
  double seconds_per_look = 0.001;  // of the stopwatch
  std::unique_ptr<servo::Loop> loop;
  std::vector<servo::LoopRecord> records;
  std::function<void(const servo::LoopRecord&)> after_step;

  explicit FakeBench(std::size_t n, const Eigen::Vector3d& answer = {kFakeSpeed, 0, 0}) : frames(n) {
    options.frame_rate_hz = 1 / kFakePeriod;
    options.latency.set_total(0.03);
    options.tip.use_marker = false;
    auto fake = std::make_unique<FakeTracker>();
    tracker = fake.get();
    stages.target_tracker = std::move(fake);
    auto eye = std::make_unique<FakeEstimator>();
    estimator = eye.get();
    stages.target_estimator = std::move(eye);
    stages.predictor = servo::predictors().make("constant_velocity", servo::PredictorOptions{});
    stages.control_law = std::make_unique<FakeLaw>(&seen, answer);
  }

  /// "" or why a tracker refuses.
  std::string start() {
    loop = std::make_unique<servo::Loop>(
        frames, robot, std::move(stages), options, Eigen::Vector3d::Zero(),
        [seconds = 0.0, step = seconds_per_look]() mutable { return seconds += step; });
    const tracking::Quad region = tracking::rectangle(0, 0, 1, 1);
    return loop->start(region, region);
  }
  void run() {
    ASSERT_EQ(start(), "");
    servo::LoopRecord record;
    while (loop->step(record)) {
      records.push_back(record);
      if (after_step) after_step(record);
    }
  }
};

}  // namespace heartservo::test
