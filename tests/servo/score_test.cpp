#include "servo/loop/score.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "servo/loop/loop_record.hpp"

namespace heartservo::servo {
namespace {

using tracking::TrackState;

LoopRecord record_at(double t, TrackState state = TrackState::OK) {
  LoopRecord r;
  r.frame.time_s = t;
  r.track.state = r.target.state = state;
  return r;
}

TEST(Score, SpreadOfKnownNumbers) {
  const Spread s = spread_of({3, -4, NAN, 0, 5});
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.mean, 1);
  EXPECT_DOUBLE_EQ(s.rms, std::sqrt(50 / 4.0));
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(50 / 4.0 - 1));
  EXPECT_DOUBLE_EQ(s.max, 5);
  EXPECT_NEAR(s.p95, 4.85, 1e-12);
  EXPECT_EQ(spread_of({}).count, 0U);
  EXPECT_EQ(spread_of({NAN}).rms, 0);
}

TEST(Score, PercentilesAreLinearBetweenRanks) {
  EXPECT_DOUBLE_EQ(percentile({4, 1, 3, 2}, 50), 2.5);
  EXPECT_DOUBLE_EQ(percentile({4, 1, 3, 2}, 100), 4);
  EXPECT_DOUBLE_EQ(percentile({}, 50), 0);
}

TEST(Score, ResidualMotionAndReductionAgainstAHandComputedRun) {
  Score score(1.0, 0.01);
  const int n = 400;
  for (int k = 0; k < n; ++k) {
    const double t = 0.01 * k;
    TruthSample truth;
    truth.target = Eigen::Vector3d(0, 0, 0.05);
    truth.goal = Eigen::Vector3d(0.003 * std::sin(2 * M_PI * t), 0, 0.05);  // whole periods after settling
    truth.tip = *truth.goal + Eigen::Vector3d(0, 0.0003, 0.0004);
    if (t < 1.0 - 1e-9) truth.tip = Eigen::Vector3d(1, 1, 1);  // not settled: must not count
    LoopRecord r = record_at(t);
    r.target.T_camera_target.translation() = *truth.target + Eigen::Vector3d(0.0001 * (k % 2 ? 1 : -1), 0, 0);
    r.command.velocity = Eigen::Vector3d(0, 0.02, 0);
    score.add(r, truth);
  }
  const ScoreSummary s = score.summary();
  EXPECT_EQ(s.frames, 400U);
  EXPECT_EQ(s.scored_frames, 300U);
  EXPECT_TRUE(s.metric);
  EXPECT_NEAR(s.residual.rms, 0.0005, 1e-12);
  EXPECT_NEAR(s.residual.p95, 0.0005, 1e-12);
  EXPECT_NEAR(s.residual_axis_rms.y(), 0.0003, 1e-12);
  EXPECT_NEAR(s.motion_rms, 0.003 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(s.motion_peak_to_peak.x(), 0.006, 1e-9);
  EXPECT_NEAR(s.reduction_percent, 100 * (1 - 0.0005 / (0.003 / std::sqrt(2.0))), 1e-6);
  EXPECT_NEAR(s.position_error_std.x(), 0.0001, 1e-12);
  EXPECT_NEAR(s.max_speed, 0.02, 1e-12);
  EXPECT_NEAR(s.max_step_m, 0.0002, 1e-12);
}

TEST(Score, LostFramesCountInTheResidual) {
  Score score(0, 0.01);
  for (int k = 0; k < 10; ++k) {
    TruthSample truth;
    truth.goal = Eigen::Vector3d(0, 0, 0.05);
    truth.target = truth.goal;
    truth.tip = *truth.goal + Eigen::Vector3d(k < 5 ? 0 : 0.002, 0, 0);
    score.add(record_at(0.01 * k, k < 5 ? TrackState::OK : TrackState::LOST), truth);
  }
  const ScoreSummary s = score.summary();
  EXPECT_EQ(s.lost_frames, 5U);
  EXPECT_EQ(s.scored_frames, 10U);
  EXPECT_EQ(s.residual.count, 10U);
  EXPECT_NEAR(s.residual.rms, 0.002 / std::sqrt(2.0), 1e-12);
}

TEST(Score, WithoutMetricTruthOnlyPixelsAreScored) {
  Score score(0, 0.04);
  for (int k = 0; k < 10; ++k) {
    TruthSample truth;
    truth.tip_px = {100, 100};
    if (k != 3) truth.goal_px = {103, 104};
    score.add(record_at(0.04 * k), truth);
  }
  const ScoreSummary s = score.summary();
  EXPECT_FALSE(s.metric);
  EXPECT_EQ(s.residual_px.count, 9U);
  EXPECT_NEAR(s.residual_px.rms, 5, 1e-12);
}

TEST(Score, NothingAddedGivesZeros) {
  const ScoreSummary s = Score(0, 0.01).summary();
  EXPECT_EQ(s.frames, 0U);
  EXPECT_EQ(s.residual.rms, 0);
  EXPECT_EQ(s.reduction_percent, 0);
}

}  // namespace
}  // namespace heartservo::servo
