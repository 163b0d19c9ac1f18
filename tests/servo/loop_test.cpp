// The loop on stages made of one line each: order, latency, coasting, holding, stopping.
#include "servo/loop/loop.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace heartservo::servo {
namespace {

using tracking::Track;
using tracking::TrackState;

constexpr double kPeriod = 0.01;

struct FakeFrames final : tracking::FrameSource {
  std::size_t count, at = 0;
  explicit FakeFrames(std::size_t n) : count(n) {}
  bool next(tracking::Frame& frame) override {
    if (at == count) return false;
    frame = tracking::Frame{};
    frame.time_s = kPeriod * static_cast<double>(at);
    frame.sequence = at++;
    return true;
  }
  cv::Size size() const override { return {1, 1}; }
  double frame_rate_hz() const override { return 1 / kPeriod; }
  std::optional<std::size_t> frame_count() const override { return count; }
  std::string description() const override { return "fake"; }
};

struct FakeRobot final : ToolRobot {
  std::vector<ToolCommand> commands;
  Eigen::Vector3d tip = Eigen::Vector3d(0, 0, 0.05);
  ToolRobotData data() const override { return {}; }
  ToolState read(double t) override { return {t, tip, Eigen::Vector3d::Zero()}; }
  void command(const ToolCommand& c) override { commands.push_back(c); }
};

// Sees the target everywhere but in frames [lost_from, lost_to).
struct FakeTracker final : tracking::TargetTracker {
  std::uint64_t lost_from = 1000, lost_to = 1000;
  std::string refusal;
  std::string start(const tracking::Frame&, const tracking::Quad&) override { return refusal; }
  Track track(const tracking::Frame& frame) override {
    Track track;
    track.time_s = frame.time_s;
    track.state = frame.sequence >= lost_from && frame.sequence < lost_to ? TrackState::LOST : TrackState::OK;
    return track;
  }
  Eigen::Vector2d carry(const Eigen::Vector2d& start_px) const override { return start_px; }
  void mark_left_out(cv::Mat&) override {}
};

// The target moves at 0.1 m/s along x.
struct FakeEstimator final : tracking::TargetEstimator {
  tracking::TargetState estimate(const Track& track) override {
    tracking::TargetState state;
    state.time_s = track.time_s;
    state.state = track.state;
    state.T_camera_target.translation() = Eigen::Vector3d(0.1 * track.time_s, 0, 0.05);
    return state;
  }
};

// Remembers what it saw; answers `answer`.
struct FakeLaw final : ControlLaw {
  std::vector<ControlState>* seen;
  Eigen::Vector3d answer;
  FakeLaw(std::vector<ControlState>* s, Eigen::Vector3d a) : seen(s), answer(std::move(a)) {}
  Eigen::Vector3d velocity(const ControlState& state) override {
    seen->push_back(state);
    return answer;
  }
};

// Beats once a second from -4 s on; remembers how far it was asked to look.
struct FakeEcg final : EcgSource {
  std::vector<double>* asked;
  long at = -9 * 125;
  explicit FakeEcg(std::vector<double>* a) : asked(a) {}
  double rate_hz() const override { return 250; }
  bool next(double until_s, EcgSample& sample) override {
    if (asked->empty() || until_s > asked->back()) asked->push_back(until_s);
    const double t = static_cast<double>(at) / 250, since = t - std::round(t);
    if (t > until_s) return false;
    sample = {t, std::exp(-0.5 * since * since / 1e-4)};
    ++at;
    return true;
  }
};

// Remembers the beats it was told.
struct FakePredictor final : MotionPredictor {
  std::vector<double>* beats;
  explicit FakePredictor(std::vector<double>* b) : beats(b) {}
  void observe(const MotionSample&) override {}
  void observe_beat(double r_peak_s) override { beats->push_back(r_peak_s); }
  Prediction predict(double) const override { return {}; }
};

struct Bench {
  FakeFrames frames;
  FakeRobot robot;
  FakeTracker* tracker = nullptr;
  std::vector<ControlState> seen;
  LoopOptions options;
  std::unique_ptr<Loop> loop;
  std::vector<LoopRecord> records;
  std::vector<double> beats, asked;  // with an ECG

  explicit Bench(std::size_t n, const Eigen::Vector3d& answer = {0.01, 0, 0}, bool with_ecg = false) : frames(n) {
    options.frame_rate_hz = 1 / kPeriod;
    options.latency.set_total(0.03);
    options.tip.use_marker = false;
    LoopStages stages;
    auto fake = std::make_unique<FakeTracker>();
    tracker = fake.get();
    stages.target_tracker = std::move(fake);
    stages.target_estimator = std::make_unique<FakeEstimator>();
    stages.predictor = predictors().make("constant_velocity", PredictorOptions{});
    if (with_ecg) {
      stages.predictor = std::make_unique<FakePredictor>(&beats);
      stages.ecg = std::make_unique<EcgMonitor>(std::make_unique<FakeEcg>(&asked));
    }
    stages.control_law = std::make_unique<FakeLaw>(&seen, answer);
    double ticks = 0;
    loop = std::make_unique<Loop>(frames, robot, std::move(stages), options, Eigen::Vector3d::Zero(),
                                  [ticks]() mutable { return ticks += 0.001; });
  }
  void run() {
    const tracking::Quad region = tracking::rectangle(0, 0, 1, 1);
    ASSERT_EQ(loop->start(region, region), "");
    LoopRecord record;
    while (loop->step(record)) records.push_back(record);
  }
};

TEST(Loop, CommandsActOneLatencyAfterTheirFrame) {
  Bench bench(20);
  bench.run();
  ASSERT_EQ(bench.robot.commands.size(), 20U);
  for (std::size_t k = 0; k < 20; ++k)
    EXPECT_NEAR(bench.robot.commands[k].acts_at_s, kPeriod * static_cast<double>(k) + 0.03, 1e-12);
}

TEST(Loop, TheLawSeesTheFutureOfTargetAndTip) {
  Bench bench(50);
  bench.run();
  const ControlState& last = bench.seen.back();
  EXPECT_NEAR(last.goal_then.position.x(), 0.1 * (last.time_s + 0.03), 1e-6);
  EXPECT_NEAR(last.goal_now.x(), 0.1 * last.time_s, 1e-12);
  // three commands of 10 ms at 0.01 m/s are on their way
  EXPECT_NEAR(last.tip_then.x() - last.tip_now.x(), 0.03 * 0.01, 1e-9);
}

TEST(Loop, ALostTargetIsCoastedThenTheToolHoldsAndThenFollowsAgain) {
  Bench bench(80);
  bench.tracker->lost_from = 30;
  bench.tracker->lost_to = 60;
  bench.options.guard.coast_s = 0.15;
  bench.run();
  EXPECT_EQ(bench.records[29].mode, LoopMode::FOLLOW);
  EXPECT_EQ(bench.records[30].mode, LoopMode::COAST);
  EXPECT_EQ(bench.records[43].mode, LoopMode::COAST);  // last seen at 0.29 s, coasted for 0.15 s
  EXPECT_EQ(bench.records[45].mode, LoopMode::HOLD);
  EXPECT_TRUE(bench.records[46].command.velocity.isZero());
  EXPECT_EQ(bench.records[60].mode, LoopMode::FOLLOW);
  EXPECT_FALSE(bench.records[40].goal_now.allFinite());
}

TEST(Loop, HoldsUntilThePredictorKnowsEnough) {
  Bench bench(5);
  bench.run();
  EXPECT_EQ(bench.records[0].mode, LoopMode::HOLD);
  EXPECT_TRUE(bench.robot.commands[0].velocity.isZero());
  EXPECT_EQ(bench.records[2].mode, LoopMode::FOLLOW);
}

TEST(Loop, ANotFiniteLawIsStoppedByTheGuardAndNothingReachesTheRobot) {
  Bench bench(50, Eigen::Vector3d(NAN, 0, 0));
  bench.run();
  EXPECT_LT(bench.records.size(), 10U);
  EXPECT_NE(bench.loop->stop_reason().find("not finite"), std::string::npos);
  for (const auto& c : bench.robot.commands) EXPECT_TRUE(c.velocity.isZero());
}

// The ECG is read up to the frame's time and no further; a beat reaches predictor and record when it has become known.
TEST(Loop, BeatsOfTheEcgReachThePredictorAfterTheirDelay) {
  Bench bench(330, {0.01, 0, 0}, true);
  bench.tracker->lost_from = 50;  // beats are heard while the target is lost
  bench.tracker->lost_to = 300;
  bench.run();
  ASSERT_EQ(bench.asked.size(), bench.records.size());
  for (std::size_t i = 0; i < bench.asked.size(); ++i) EXPECT_EQ(bench.asked[i], bench.records[i].frame.time_s);
  ASSERT_EQ(bench.beats.size(), 8U);  // -4 to 3 s, some from before the first frame
  for (std::size_t k = 0; k < bench.beats.size(); ++k) EXPECT_NEAR(bench.beats[k], static_cast<double>(k) - 4, 1e-3);
  std::size_t heard = 0;
  for (const auto& record : bench.records) {
    if (std::isnan(record.r_peak_s) || record.r_peak_s < 0.5) continue;
    ++heard;
    const double delay = record.frame.time_s - record.r_peak_s;
    EXPECT_GT(delay, 0.1);
    EXPECT_LT(delay, 0.13 + kPeriod);
  }
  EXPECT_EQ(heard, 3U);
}

TEST(Loop, SaysWhyATrackerRefuses) {
  Bench bench(5);
  bench.tracker->refusal = "too small";
  const tracking::Quad region = tracking::rectangle(0, 0, 1, 1);
  EXPECT_EQ(bench.loop->start(region, region), "too small");
  Bench empty(0);
  EXPECT_EQ(empty.loop->start(region, region), "there is no frame");
}

}  // namespace
}  // namespace heartservo::servo
