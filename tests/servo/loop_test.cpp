// The loop's order and clock.
#include "tests/servo/fake_stages.hpp"

namespace heartservo::servo {
namespace {

using test::FakeBench;
using test::kFakePeriod;
using test::kFakeSpeed;

TEST(Loop, CommandsActOneLatencyAfterTheirFrameAndExpire) {
  FakeBench bench(20);
  bench.run();
  ASSERT_EQ(bench.robot.commands.size(), 20U);
  for (std::size_t k = 0; k < 20; ++k) {
    EXPECT_NEAR(bench.robot.commands[k].acts_at_s, kFakePeriod * static_cast<double>(k) + 0.03, 1e-12);
    EXPECT_NEAR(bench.robot.commands[k].expires_at_s - bench.robot.commands[k].acts_at_s,
                bench.options.guard.command_life_s, 1e-12);
  }
}

TEST(Loop, TheLawSeesTheFutureOfTargetAndRobot) {
  FakeBench bench(50);
  bench.run();
  const ControlState& last = bench.seen.back();
  EXPECT_NEAR(last.goal_then.position.x(), kFakeSpeed * (last.time_s + 0.03), 1e-6);
  EXPECT_NEAR(last.goal_now.x(), kFakeSpeed * last.time_s, 1e-12);
  EXPECT_NEAR(last.goal(-1).position.x(), kFakeSpeed * (last.time_s + 0.03 - kFakePeriod), 1e-6);
  // three commands of 10 ms are on their way
  EXPECT_NEAR(last.robot.reference.x() - last.tip_now.x(), 0.03 * kFakeSpeed, 1e-9);
  EXPECT_NEAR(last.robot.reference_velocity.x(), kFakeSpeed, 1e-9);
  EXPECT_NEAR(last.last_velocity.x(), kFakeSpeed, 1e-12);
}

// law -> feed-forward -> filter -> limits -> finite check: each acts on what the one before made.
TEST(Loop, TheSequenceIsLawFeedForwardFilterLimitFiniteCheck) {
  struct Law final : ControlLaw {
    Eigen::Vector3d velocity(const ControlState&) override { return {0, 0.5, 0}; }
    int horizon() const override { return 2; }
    bool wants_feed_forward() const override { return true; }
  };
  FakeBench bench(60);
  bench.stages.control_law = std::make_unique<Law>();
  bench.options.guard.workspace_radius_m = 10;
  bench.options.guard.max_error_m = 10;
  bench.options.guard.max_step_m = 1;
  bench.options.guard.max_speed = 0.3;
  bench.options.guard.max_acceleration = 1000;
  bench.run();
  const Eigen::Vector3d v = bench.records.back().command.velocity;
  const Eigen::Vector3d sum(kFakeSpeed, 0.5, 0);  // law plus feed-forward, shortened as a whole
  EXPECT_LT((v - sum * (0.3 / sum.norm())).norm(), 1e-6);
  FakeBench filtered(4);  // frame 1 is the first with a prediction
  filtered.stages.control_law = std::make_unique<Law>();
  filtered.options.control.filter_hz = 5;
  filtered.options.guard.max_acceleration = 1000;
  filtered.run();
  EXPECT_NEAR(filtered.records[1].guard.velocity.y(), 0.5 * (1 - std::exp(-2 * M_PI * 5 * kFakePeriod)), 1e-9);
  EXPECT_FALSE(filtered.records[1].guard.limited());
}

TEST(Loop, HoldsUntilThePredictorKnowsEnough) {
  FakeBench bench(5);
  bench.run();
  EXPECT_EQ(bench.records[0].mode, LoopMode::HOLD);
  EXPECT_TRUE(bench.robot.commands[0].velocity.isZero());
  EXPECT_EQ(bench.records[2].mode, LoopMode::FOLLOW);
}

// The ECG is read up to the frame's time and no further; a beat reaches predictor and record when it has become known.
TEST(Loop, BeatsOfTheEcgReachThePredictorAfterTheirDelay) {
  FakeBench bench(330);
  std::vector<double> beats, asked;
  bench.stages.predictor = std::make_unique<test::FakePredictor>(&beats);
  bench.stages.ecg = std::make_unique<EcgMonitor>(std::make_unique<test::FakeEcg>(&asked));
  bench.tracker->lost_from = 50;  // beats are heard while the target is lost
  bench.tracker->lost_to = 300;
  bench.run();
  ASSERT_EQ(asked.size(), bench.records.size());
  for (std::size_t i = 0; i < asked.size(); ++i) EXPECT_EQ(asked[i], bench.records[i].frame.time_s);
  ASSERT_EQ(beats.size(), 8U);  // -4 to 3 s, some from before the first frame
  for (std::size_t k = 0; k < beats.size(); ++k) EXPECT_NEAR(beats[k], static_cast<double>(k) - 4, 1e-3);
  std::size_t heard = 0;
  for (const auto& record : bench.records) {
    if (std::isnan(record.r_peak_s) || record.r_peak_s < 0.5) continue;
    ++heard;
    const double delay = record.frame.time_s - record.r_peak_s;
    EXPECT_GT(delay, 0.1);
    EXPECT_LT(delay, 0.13 + kFakePeriod);
  }
  EXPECT_EQ(heard, 3U);
}

TEST(Loop, SaysWhyATrackerRefuses) {
  FakeBench bench(5);
  bench.tracker->refusal = "too small";
  EXPECT_EQ(bench.start(), "too small");
  FakeBench empty(0);
  EXPECT_EQ(empty.start(), "there is no frame");
}

}  // namespace
}  // namespace heartservo::servo
