// Every guard of the loop, triggered.
#include "tests/servo/fake_stages.hpp"

namespace heartservo::servo {
namespace {

using test::FakeBench;
using test::kFakePeriod;
using test::kFakeSpeed;

TEST(LoopSafety, ALostTargetIsCoastedHeldRetractedFromAndApproachedAgain) {
  FakeBench bench(260);
  bench.tracker->lost_from = 30;
  bench.tracker->lost_to = 150;
  bench.options.guard.coast_s = 0.15;
  bench.options.guard.hold_s = 0.2;
  bench.options.guard.retract_m = 0.004;
  bench.options.guard.retract_speed = 0.02;
  bench.options.guard.approach_speed = 0.05;
  bench.options.guard.resume_frames = 6;
  bench.options.tool_axis = {0, 0, -2};
  bench.run();
  const auto mode = [&](std::size_t k) { return bench.records[k].mode; };
  EXPECT_EQ(mode(29), LoopMode::FOLLOW);
  EXPECT_EQ(mode(30), LoopMode::COAST);
  EXPECT_EQ(mode(43), LoopMode::COAST);  // last seen at 0.29 s, coasted for 0.15 s
  EXPECT_NEAR(bench.records[43].command.velocity.x(), kFakeSpeed, 1e-9);
  EXPECT_FALSE(bench.records[40].goal_now.allFinite());
  EXPECT_EQ(mode(45), LoopMode::HOLD);
  EXPECT_EQ(mode(64), LoopMode::HOLD);
  EXPECT_EQ(mode(67), LoopMode::RETRACT);
  // retracted along the axis from where the target was last seen
  const Eigen::Vector3d place = bench.records[29].tip + Eigen::Vector3d(0, 0, -0.004);
  EXPECT_LT((bench.records[149].tip - place).norm(), 1e-4);
  EXPECT_EQ(mode(154), LoopMode::RETRACT);  // seen five times only
  EXPECT_EQ(mode(155), LoopMode::RESUME);
  EXPECT_EQ(mode(259), LoopMode::FOLLOW);
  // the fake law does not steer, but what it is asked to approach moves at the stated speed at most
  double fastest = 0;
  for (std::size_t k = 155; k + 1 < 259; ++k) {
    const Prediction a = bench.records[k].goal_then, b = bench.records[k + 1].goal_then;
    fastest = std::max(fastest, ((b.position - a.position) / kFakePeriod - Eigen::Vector3d(kFakeSpeed, 0, 0)).norm());
  }
  EXPECT_NEAR(fastest, 0.05, 0.003);
}

TEST(LoopSafety, AnotherRegionIsHeldForAndThenApproachedSlowly) {
  FakeBench bench(200);
  bench.options.guard.resume_frames = 6;
  bench.options.guard.approach_speed = 0.05;
  const auto other = [](const std::string& refusal) {
    LoopStages stages;
    auto tracker = std::make_unique<test::FakeTracker>();
    tracker->refusal = refusal;
    stages.target_tracker = std::move(tracker);
    auto eye = std::make_unique<test::FakeEstimator>();
    eye->offset_after_s = 0;
    eye->offset = {0, 0.003, 0};
    stages.target_estimator = std::move(eye);
    stages.predictor = predictors().make("constant_velocity", PredictorOptions{});
    return stages;
  };
  bench.after_step = [&](const LoopRecord& record) {
    const auto sequence = record.frame.sequence;
    if (sequence != 20 && sequence != 49) return;
    const std::string refusal = sequence == 20 ? "too small" : "";
    EXPECT_EQ(bench.loop->restart(other(refusal), tracking::rectangle(0, 0, 1, 1)), refusal);
  };
  bench.run();
  const auto mode = [&](std::size_t k) { return bench.records[k].mode; };
  for (std::size_t k = 21; k < 50; ++k) EXPECT_EQ(mode(k), LoopMode::FOLLOW) << k << ": a refusal changes nothing";
  for (std::size_t k = 50; k < 55; ++k) EXPECT_EQ(mode(k), LoopMode::HOLD) << k;
  EXPECT_EQ(mode(55), LoopMode::RESUME) << "seen six times";
  EXPECT_EQ(mode(199), LoopMode::FOLLOW);
  EXPECT_NEAR(bench.records[60].carried.y(), 0.003, 1e-9);
  double fastest = 0;
  for (std::size_t k = 50; k < 200; ++k) EXPECT_FALSE(bench.records[k].implausible) << "it may be anywhere";
  for (std::size_t k = 55; k + 1 < 199; ++k) {
    const Prediction a = bench.records[k].goal_then, b = bench.records[k + 1].goal_then;
    fastest = std::max(fastest, ((b.position - a.position) / kFakePeriod - Eigen::Vector3d(kFakeSpeed, 0, 0)).norm());
  }
  EXPECT_LT(fastest, 0.053);
}

TEST(LoopSafety, AShortLossIsOnlyCoasted) {
  FakeBench bench(60);
  bench.tracker->lost_from = 30;
  bench.tracker->lost_to = 33;
  bench.run();
  EXPECT_EQ(bench.records[32].mode, LoopMode::COAST);
  EXPECT_EQ(bench.records[33].mode, LoopMode::FOLLOW);
}

TEST(LoopSafety, AfterALongerCoastTheGoalIsApproachedAtOnceAndSlowly) {
  FakeBench bench(80);
  bench.tracker->lost_from = 30;
  bench.tracker->lost_to = 42;
  bench.estimator->offset_after_s = 0.42;  // the target was foreseen 3 mm from where it comes back
  bench.estimator->offset = {0, 0.003, 0};
  bench.options.guard.max_target_speed = 10;
  bench.options.guard.approach_speed = 0.05;
  bench.run();
  EXPECT_EQ(bench.records[41].mode, LoopMode::COAST);
  EXPECT_EQ(bench.records[42].mode, LoopMode::RESUME);
  EXPECT_EQ(bench.records[79].mode, LoopMode::FOLLOW);
  double fastest = 0;
  for (std::size_t k = 42; k + 1 < 80; ++k)
    fastest = std::max(
        fastest,
        std::abs(bench.records[k + 1].goal_then.position.y() - bench.records[k].goal_then.position.y()) / kFakePeriod);
  EXPECT_LT(fastest, 0.1) << "3 mm in one period would be 0.3 m/s";
  EXPECT_NEAR(bench.records[79].goal_then.position.y(), 0.003, 1e-4);
}

TEST(LoopSafety, ACoastEndsWhereThePredictionLeavesWhatWasSeen) {
  FakeBench bench(80);
  bench.tracker->lost_from = 30;
  bench.options.guard.coast_s = 1;
  bench.options.guard.coast_beyond_m = 0.004;
  bench.run();
  // seen up to 0.29 s; 4 mm further at 0.49 s, which a command that acts 0.03 s later reaches at 0.46 s
  EXPECT_EQ(bench.records[45].mode, LoopMode::COAST);
  EXPECT_EQ(bench.records[47].mode, LoopMode::HOLD);
  double furthest = 0;
  for (const auto& r : bench.records) furthest = std::max(furthest, r.tip.x() - bench.records[29].tip.x());
  EXPECT_LT(furthest, 0.0045);
}

TEST(LoopSafety, AWithdrawnToolWaitsUntilTheTargetIsSeenSeveralTimesInARow) {
  FakeBench bench(200);
  bench.tracker->lost_from = 30;
  bench.tracker->lost_to = 1000;
  bench.run();
  EXPECT_EQ(bench.records.back().mode, LoopMode::RETRACT);
  EXPECT_EQ(bench.loop->stop_reason(), "");
}

TEST(LoopSafety, ANotFiniteLawIsStoppedAndNothingReachesTheRobot) {
  FakeBench bench(50, Eigen::Vector3d(NAN, 0, 0));
  bench.run();
  EXPECT_LT(bench.records.size(), 10U);
  EXPECT_NE(bench.loop->stop_reason().find("not finite"), std::string::npos);
  for (const auto& c : bench.robot.commands) EXPECT_TRUE(c.velocity.isZero());
}

TEST(LoopSafety, AJumpOfTheTargetIsNotBelieved) {
  FakeBench bench(60);
  bench.estimator->jump_at_s = 0.3;
  bench.run();
  for (const auto& r : bench.records) EXPECT_EQ(r.implausible, r.frame.sequence == 30 || r.frame.sequence == 31);
  EXPECT_EQ(bench.records[30].mode, LoopMode::COAST);
  EXPECT_EQ(bench.records[32].mode, LoopMode::FOLLOW);
  for (std::size_t k = 20; k < 60; ++k)
    EXPECT_NEAR(bench.records[k].goal_then.position.x(), kFakeSpeed * (bench.records[k].frame.time_s + 0.03), 1e-5);
}

TEST(LoopSafety, ARepeatedFrameIsNotUsed) {
  FakeBench bench(60);
  bench.frames.repeated = 30;
  bench.run();
  for (const auto& r : bench.records) EXPECT_EQ(r.stale, r.frame.sequence == 30);
  EXPECT_EQ(bench.records[30].mode, LoopMode::COAST);
}

TEST(LoopSafety, AFrameThatArrivesTooLateIsNotUsed) {
  FakeBench bench(60);
  bench.options.guard.max_frame_age_s = 0.05;
  bench.stages.frame_clock = [&] {  // however often it is looked at in a frame
    const double taken = kFakePeriod * static_cast<double>(bench.frames.at - 1);
    return taken + (taken > 0.295 && taken < 0.335 ? 0.06 : 0.02);
  };
  bench.run();
  int stale = 0;
  for (const auto& r : bench.records) stale += r.stale;
  EXPECT_EQ(stale, 4);
}

TEST(LoopSafety, AfterADropOutOfTheCameraTheTargetMustBeSeenSeveralTimes) {
  FakeBench bench(100);
  bench.frames.gap_at = 40;
  bench.frames.gap_s = 0.4;
  bench.run();
  EXPECT_EQ(bench.records[39].mode, LoopMode::FOLLOW);
  EXPECT_EQ(bench.records[40].mode, LoopMode::HOLD);
  EXPECT_EQ(bench.records[43].mode, LoopMode::HOLD);
  EXPECT_EQ(bench.records[44].mode, LoopMode::RESUME);
  EXPECT_EQ(bench.records[99].mode, LoopMode::FOLLOW);
  // and meanwhile the robot stopped by itself, command_life_s after the last command began
  EXPECT_LT((bench.records[40].tip - bench.records[39].tip).norm(),
            kFakeSpeed * (0.03 + bench.options.guard.command_life_s) + 1e-6);
}

TEST(LoopSafety, ComputingThatIsTooSlowStops) {
  FakeBench bench(60);
  bench.options.guard.max_chain_s = 0.002;
  bench.options.guard.slow_frames_to_stop = 4;
  bench.seconds_per_look = 0.0005;  // the chain looks four times
  bench.run();
  EXPECT_EQ(bench.records.size(), 60U) << bench.loop->stop_reason();
  FakeBench slow(60);
  slow.options.guard = bench.options.guard;
  slow.seconds_per_look = 0.001;
  slow.run();
  EXPECT_EQ(slow.records.size(), 4U);
  EXPECT_NE(slow.loop->stop_reason().find("compute"), std::string::npos) << slow.loop->stop_reason();
}

TEST(LoopSafety, TooMuchForceStops) {
  FakeBench bench(60);
  bench.after_step = [&](const LoopRecord& r) { bench.robot.force_n = 0.2 * static_cast<double>(r.frame.sequence); };
  bench.options.guard.max_force_n = 4;
  bench.run();
  EXPECT_NE(bench.loop->stop_reason().find("force"), std::string::npos);
  EXPECT_TRUE(bench.robot.commands.back().velocity.isZero());
  EXPECT_EQ(bench.records.size(), 23U);
}

TEST(LoopSafety, ALawThatRunsAwayIsStopped) {
  FakeBench bench(200, {-0.2, 0, 0});
  bench.options.guard.workspace_radius_m = 1;
  bench.run();
  EXPECT_NE(bench.loop->stop_reason().find("diverges"), std::string::npos) << bench.loop->stop_reason();
  FakeBench out(200, {-0.2, 0, 0});
  out.options.guard.max_error_m = 1;
  out.run();
  EXPECT_NE(out.loop->stop_reason().find("workspace"), std::string::npos) << out.loop->stop_reason();
}

}  // namespace
}  // namespace heartservo::servo
