#include "tools/sweep/sweep_plan.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"
#include "tools/sweep/sweep_statistics.hpp"
#include "tools/sweep/sweep_store.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {
namespace {

class Sweep : public testing::Test {
 protected:
  SweepPlan plan(const std::string& body) const {
    const std::string file = (folder_ / "sweep.yaml").string();
    test::write_text(file, "scene: " HEARTSERVO_SOURCE_DIR "/scenes/pig_2007.yaml\n" + body);
    return read_sweep(file);
  }
  std::string refusal(const std::string& body) const {
    try {
      (void)plan(body);
    } catch (const std::exception& e) {
      return e.what();
    }
    return "";
  }
  const test::TemporaryFolder folder_;
};

TEST_F(Sweep, TheProductIsCountedAndTheFirstAxisVariesSlowest) {
  const SweepPlan p = plan(
      "set: {duration_s: 3, settle_s: 1}\naxes:\n  engines.predictor: [hold, mixture]\n  latency_ms: [8, 16, 32]\n"
      "  seed: {from: 4, to: 7}\n");
  EXPECT_EQ(p.runs(), 24u);
  EXPECT_EQ(p.values(0), (std::vector<std::string>{"hold", "8", "4"}));
  EXPECT_EQ(p.values(1), (std::vector<std::string>{"hold", "8", "5"}));
  EXPECT_EQ(p.values(23), (std::vector<std::string>{"mixture", "32", "7"}));
  const sim::Scene scene = p.scene_of(23);
  EXPECT_EQ(scene.engines.predictor, "mixture");
  EXPECT_NEAR(scene.loop.latency.total_s(), 0.032, 1e-12);
  EXPECT_EQ(scene.seed, 7);
  EXPECT_EQ(scene.duration_s, 3);
  EXPECT_EQ(scene.engines.tracker, "esm") << "the rest is the scene's";
}

TEST_F(Sweep, RangesWithStepsAndListsOfLists) {
  const SweepPlan p =
      plan("axes:\n  motion.heart_rate_hz: {from: 1, to: 2, steps: 5}\n  loop.offset_m: [[0, 0, 0], [0.001, 0, 0]]\n");
  EXPECT_EQ(p.runs(), 10u);
  EXPECT_NEAR(p.scene_of(2).motion.heart_rate_hz, 1.25, 1e-12);
  EXPECT_EQ(p.scene_of(1).loop.offset_m.x(), 0.001);
}

TEST_F(Sweep, WhatCannotBeMeantIsRefusedWithItsPlace) {
  EXPECT_NE(refusal("axes:\n  engines.predictr: [hold]\n").find("did you mean 'predictor'"), std::string::npos);
  EXPECT_NE(refusal("axes:\n  engines.predictor: [holt]\n").find("did you mean 'hold'"), std::string::npos);
  EXPECT_NE(refusal("axes:\n  seed: []\n").find("no values"), std::string::npos);
  EXPECT_NE(refusal("axis: 3\n").find("did you mean 'axes'"), std::string::npos);
  EXPECT_NE(refusal("axes: {}\n").find("axes is missing"), std::string::npos);
  EXPECT_NE(refusal("axes:\n  seed: {from: 5, to: 1}\n").find("in this order"), std::string::npos);
  EXPECT_NE(refusal("axes:\n  seed: [1]\nmetrics: 3\n").find("metrics"), std::string::npos);
  EXPECT_NE(refusal("axes:\n  seed.more: [1]\n").find("not a group"), std::string::npos);
}

TEST_F(Sweep, HugeProductsSaturate) {
  std::string axes = "axes:\n";
  for (const char* key : {"motion.heart_rate_hz", "picture.noise_grey", "motion.amplitude_scale", "robot.bandwidth_hz"})
    axes += std::string("  ") + key + ": {from: 1, to: 2, steps: 100000}\n";
  EXPECT_GT(plan(axes).runs(), std::uint64_t{1} << 60);
}

TEST_F(Sweep, ResultsAreKeptThroughACrashInTheMiddleOfALine) {
  const SweepPlan p = plan("axes:\n  seed: {from: 1, to: 4}\nmetrics: [residual.rms_mm]\n");
  const auto out = folder_ / "swept";
  {
    SweepStore store(out, p, 0);
    store.add({0, "done", {0.25}, 1.5, ""});
    store.add({2, "failed", {NAN}, 0.1, "said \"no\", twice"});
    EXPECT_THROW(SweepStore(out, p, 0), ConfigError) << "two at once";
  }
  test::write_text((out / "runs.csv").string(), test::read_text((out / "runs.csv").string()) + "3,4,do");
  SweepStore store(out, p, 0);
  EXPECT_TRUE(store.has(0));
  EXPECT_FALSE(store.has(1));
  EXPECT_FALSE(store.has(3)) << "half a line";
  EXPECT_EQ(store.results().at(0).metrics[0], 0.25);
  EXPECT_EQ(store.results().at(2).error, "said \"no\", twice");
  store.add({3, "done", {0.5}, 1, ""});
  store.write_sorted();
  EXPECT_EQ(test::read_text((out / "results.csv").string()),
            "run,seed,status,residual.rms_mm,seconds,error\n0,1,done,0.25,1.500,\n2,3,failed,,0.100,\"said \"\"no\"\", "
            "twice\"\n3,4,done,0.5,1.000,\n");
}

TEST_F(Sweep, AFolderOfAnotherSweepIsRefused) {
  const SweepPlan p = plan("axes:\n  seed: {from: 1, to: 4}\n");
  { SweepStore(folder_ / "swept", p, 0).add({1, "done", std::vector<double>(p.metrics.size(), 0.5), 1, ""}); }
  const SweepPlan other = plan("axes:\n  seed: {from: 2, to: 5}\n");
  EXPECT_THROW(SweepStore(folder_ / "swept", other, 0), ConfigError) << "other values";
  const SweepPlan third = plan("axes:\n  picture.noise_grey: [1, 2]\n");
  EXPECT_THROW(SweepStore(folder_ / "swept", third, 0), ConfigError) << "other axes";
}

TEST_F(Sweep, SharesMergeIntoTheWhole) {
  const SweepPlan p = plan("axes:\n  seed: {from: 1, to: 4}\nmetrics: [residual.rms_mm]\n");
  const auto out = folder_ / "shared";
  for (int share : {1, 2}) {
    SweepStore store(out, p, share);
    for (std::uint64_t run = static_cast<std::uint64_t>(share - 1); run < 4; run += 2)
      store.add({run, "done", {static_cast<double>(run)}, 1, ""});
  }
  SweepStore whole(out, p, 0);
  whole.merge();
  EXPECT_EQ(whole.results().size(), 4u);
  EXPECT_EQ(whole.results().at(3).metrics[0], 3);
}

TEST_F(Sweep, WhatAShareRepeatedWellReplacesAFailure) {
  const SweepPlan p = plan("axes:\n  seed: {from: 1, to: 4}\nmetrics: [residual.rms_mm]\n");
  const auto out = folder_ / "shared";
  {
    SweepStore share(out, p, 1);
    share.add({0, "failed", {NAN}, 1, "crashed"});
    share.add({2, "done", {2}, 1, ""});
    SweepStore whole(out, p, 0);
    whole.merge();
    EXPECT_EQ(whole.results().at(0).status, "failed");
    share.forget_failed();
    EXPECT_FALSE(share.has(0));
    share.add({0, "done", {0.5}, 1, ""});
  }
  SweepStore whole(out, p, 0);
  EXPECT_EQ(whole.results().at(0).status, "failed") << "as it was merged";
  whole.merge();
  EXPECT_EQ(whole.results().at(0).metrics[0], 0.5);
  SweepStore other(out, p, 2);
  EXPECT_EQ(other.elsewhere().size(), 2u) << "with other shares their runs are not done again";
}

TEST(SweepStatistics, MediansAndTheirIntervals) {
  const Interval one = median_interval({3});
  EXPECT_EQ(one.median, 3);
  EXPECT_EQ(one.low, 3);
  std::vector<double> values;
  for (int i = 0; i < 101; ++i) values.push_back(i);
  const Interval many = median_interval(values);
  EXPECT_EQ(many.median, 50);
  EXPECT_NEAR(many.low, 40, 4) << "binomial: 40.2";
  EXPECT_NEAR(many.high, 60, 4);
  EXPECT_EQ(median_interval({NAN, 1, 2}).median, 1.5);
  EXPECT_EQ(median_interval({}).count, 0u);
}

TEST_F(Sweep, PairsAreComparedOnTheSameSeeds) {
  const SweepPlan p =
      plan("axes:\n  engines.predictor: [hold, mixture]\n  seed: {from: 1, to: 3}\nmetrics: [residual.rms_mm]\n");
  std::map<std::uint64_t, SweepResult> results;
  for (std::uint64_t i = 0; i < 6; ++i)
    results[i] = {i, "done", {i < 3 ? 2.0 + static_cast<double>(i) : 0.1 * static_cast<double>(i)}, 1, ""};
  const auto j = sweep_statistics(p, results);
  ASSERT_EQ(j["groups"].size(), 2u);
  EXPECT_EQ(j["groups"][0]["metrics"]["residual.rms_mm"]["median"], 3.0);
  ASSERT_EQ(j["pairs"].size(), 1u);
  EXPECT_NEAR(j["pairs"][0]["median_difference"].get<double>(), 3 - 0.4, 1e-12);
  EXPECT_EQ(j["pairs"][0]["a_is_less"], 0.0);
}

}  // namespace
}  // namespace heartservo::tools
