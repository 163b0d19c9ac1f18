// What `servo` says about control: comparisons, sweeps, refusals, robots, paths.
#include <signal.h>

#include "tests/tools/command/command_fixture.hpp"
#include "tools/time_table.hpp"

namespace heartservo::test {
namespace {

using nlohmann::json;
using ServoControl = CommandLine;

TEST_F(ServoControl, SeveralPredictorsAndLawsStandSideBySide) {
  const Outcome o = run({"servo", scene("pig_2007"), "--frames", "40", "--predictor", "hold,constant_velocity",
                         "--controller", "ibvs,mpc", "--json", "--quiet", "--out", "run"});
  EXPECT_EQ(o.code, 0) << o.err;
  const json j = json_of(o);
  ASSERT_EQ(j["comparison"].size(), 4u);
  double least = INFINITY;
  for (const auto& row : j["comparison"]) least = std::min(least, row["residual"]["rms_mm"].get<double>());
  EXPECT_EQ(j["residual"]["rms_mm"].get<double>(), least) << "the rest of the summary is about the best";
  EXPECT_EQ(j["comparison"][3]["predictor"], "constant_velocity");
  EXPECT_EQ(j["comparison"][3]["controller"], "mpc");
  expect_complete("run");
  // a row of the table is what a run of its own gives
  const json alone = json_of(run({"servo", scene("pig_2007"), "--frames", "40", "--predictor", "hold", "--controller",
                                  "mpc", "--json", "--quiet"}));
  EXPECT_EQ(alone["residual"], j["comparison"][1]["residual"]);
}

TEST_F(ServoControl, UnknownNamesInAListAreRefused) {
  expect_refused(2, {"servo", scene("pig_2007"), "--controller", "ibvs,mcp"}, {"mcp", "did you mean 'mpc'"});
  expect_refused(2, {"servo", scene("pig_2007"), "--predictor", "holt"}, {"did you mean 'hold'"});
  expect_refused(2, {"servo", scene("pig_2007"), "--robot", "trokar"}, {"did you mean 'trocar'"});
}

TEST_F(ServoControl, ASweepTellsWhatIsLeftOfEachFrequency) {
#ifdef HEARTSERVO_SANITIZED
  GTEST_SKIP() << "takes too long under sanitizers";
#endif
  expect_refused(2, {"servo", scene("pig_2007"), "--sweep-frequency", "10:1"}, {"--sweep-frequency", "LOW:HIGH"});
  expect_refused(2, {"servo", scene("pig_2007"), "--sweep-frequency", "1:2", "--predictor", "all"}, {"one predictor"});
  int rounds = 0;  // a whole sweep takes long: end it, and see that what was done is there
  const Outcome o = run({"servo", scene("pig_2007"), "--sweep-frequency", "4:8", "--controller", "ibvs", "--json",
                         "--quiet", "--out", "run"},
                        [&](pid_t child) {
                          if (fs::exists(folder_ / "run.partial/incomplete") && ++rounds == 20) ::kill(child, SIGINT);
                        });
  EXPECT_EQ(o.code, 130) << o.err;
  EXPECT_TRUE(json_of(o).contains("sweep"));
  expect_complete("run");
}

TEST_F(ServoControl, HopelessRunsAreRefusedBeforeTheyBegin) {
  const auto refused = [&](const std::string& loop, std::vector<std::string> more,
                           const std::vector<std::string>& parts) {
    const std::string file = edited_scene({{"loop:\n", "loop:\n" + loop}});
    more.insert(more.begin(), {"servo", file, "--out", "run"});
    expect_refused(2, more, parts);
    EXPECT_FALSE(fs::exists(folder_ / "run"));
    EXPECT_FALSE(fs::exists(folder_ / "run.partial"));
  };
  refused("  control: {gain: 80}\n", {"--controller", "ibvs"}, {"loop.control.gain", "unstable"});
  refused("  guard: {max_speed: 0}\n", {}, {"loop.guard.max_speed"});
  refused("", {"--latency-ms", "500"}, {"loop.latency", "max_prediction_s"});
  refused("  path: {type: circle, size_m: 0.04}\n  guard: {workspace_radius_m: 0.02}\n", {}, {"loop.path", "workspace"});
  refused("  force: {wanted_n: 0.5, gain: 0.2}\n", {}, {"loop.force.gain", "unstable"});
  refused("  eye_in_hand: true\n", {}, {"loop.tip.use_marker"});
}

TEST_F(ServoControl, ARecordedHandIsReadAndItsMistakesAreNamedByLine) {
  const std::string file = edited_scene({{"loop:\n", "loop:\n  path: {type: file, file: hand.csv, start_s: 0.05}\n"}});
  const auto run_it = [&] { return std::vector<std::string>{"servo", file, "--frames", "30", "--quiet", "--out", "run"}; };
  expect_refused(3, run_it(), {"hand.csv"});
  write_text(folder_ / "hand.csv", "time_s,x_m,y_m,z_m\n0,0,0,0\n0.1,0.001,0,0\n0.1,0.002,0,0\n");
  expect_refused(3, run_it(), {"hand.csv:4", "time_s"});
  write_text(folder_ / "hand.csv", "time_s,x_m,y_m\n0,0,0\n0.1,0.001,0\n");
  expect_refused(3, run_it(), {"hand.csv", "z_m"});
  write_text(folder_ / "hand.csv", "time_s,x_m,y_m,z_m\n0,0,0,0\n0.1,0.001,0,0\n0.5,0.002,0,0\n");
  EXPECT_EQ(run(run_it()).code, 0);
  // the goal goes where the hand goes
  const auto frames = tools::TimeTable::read_csv(folder_ / "run/frames.csv");
  const auto measured = frames.column("measured/x_m"), goal = frames.column("goal/measured/x_m");
  EXPECT_NEAR((goal[29] - measured[29]) - (goal[3] - measured[3]), 0.00165, 3e-4);
}

TEST_F(ServoControl, EveryRobotCloses) {
  for (const char* robot : {"ideal", "cartesian", "trocar", "visp"}) {
    const Outcome o =
        run({"servo", scene("pig_2007"), "--frames", "60", "--settle-s", "0.25", "--robot", robot, "--json", "--quiet"});
    EXPECT_EQ(o.code, 0) << o.err;
    const json j = json_of(o);
    EXPECT_EQ(j["robot"], robot);
    EXPECT_LT(j["residual"]["rms_mm"], 1.5) << robot;
  }
}

using Stabilise = CommandLine;

TEST_F(Stabilise, TheRegionStandsStillInTheVideo) {
  const Outcome o =
      run({"stabilise", scene("pig_2007"), "--frames", frames(60), "--json", "--quiet", "--out", "run"});
  EXPECT_EQ(o.code, 0) << o.err;
  const json j = json_of(o);
  EXPECT_GT(j["motion_px"]["raw"], 5);
  EXPECT_LT(j["motion_px"]["still"], 0.05 * j["motion_px"]["raw"].get<double>());
  EXPECT_EQ(j["lost_frames"], 0);
  EXPECT_GT(fs::file_size(folder_ / "run/video.mkv"), 10000u);
  expect_complete("run");
}

TEST_F(Stabilise, RecordedFramesToo) {
  const Outcome o = run({"stabilise", sequence("waves", 30), "--roi", "50,40,50,40", "--json", "--quiet"});
  EXPECT_EQ(o.code, 0) << o.err;
  const json j = json_of(o);
  EXPECT_NEAR(j["motion_px"]["raw"].get<double>(), 0.5 * 30 / std::sqrt(12.0), 0.3);
  EXPECT_LT(j["motion_px"]["still"], 0.3);
  expect_refused(2, {"stabilise", "waves", "--tracker", "esn"}, {"did you mean 'esm'"});
  expect_refused(3, {"stabilise", "nowhere.yaml"}, {"nowhere.yaml"});
}

}  // namespace
}  // namespace heartservo::test
