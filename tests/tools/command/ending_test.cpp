// How a run ends: by its seed's numbers, by Ctrl-C, by the guard; and where it is put.
#include <unistd.h>

#include "tests/tools/command/command_fixture.hpp"
#include "tools/time_table.hpp"

namespace heartservo::test {
namespace {

using nlohmann::json;
using Ending = CommandLine;

TEST_F(Ending, TheSameSeedGivesTheSameNumbers) {
  const auto summary = [&](const char* command, const char* seed) {
    json j = json_of(run({command, scene("pig_2007"), "--frames", "30", "--seed", seed, "--json", "--quiet"}));
    j.erase("timing");
    for (auto& tracker : j.value("trackers", json::array())) tracker.erase("ms");
    return j;
  };
  const json a = summary("servo", "3"), b = summary("servo", "3"), c = summary("servo", "4");
  EXPECT_EQ(a, b);
  EXPECT_EQ(a["seed"], 3);
  EXPECT_NE(a["residual"], c["residual"]);
  const json t = summary("track", "3")["trackers"][0]["error_px"];
  EXPECT_EQ(t, summary("track", "3")["trackers"][0]["error_px"]);
  EXPECT_NE(t, summary("track", "4")["trackers"][0]["error_px"]);
}

TEST_F(Ending, CtrlCLeavesACompleteRunOfWhatWasDone) {
  for (const std::string command : {"servo", "track", "render"}) {
    int rounds = 0;
    const Outcome o = run({command, scene("pig_2007"), "--json", "--quiet", "--out", command}, [&](pid_t child) {
      if (fs::exists(folder_ / (command + ".partial/incomplete")) && ++rounds == 15) ::kill(child, SIGINT);
    });
    EXPECT_EQ(o.code, 130) << command << o.err;
    EXPECT_EQ(o.err, "");
    const json j = json_of(o);
    EXPECT_EQ(j["interrupted"], true);
    EXPECT_GT(j["frames"], 0);
    EXPECT_LT(j["frames"], 1900);
    EXPECT_EQ(j, summary_of(command));
    expect_complete(command);
  }
}

TEST_F(Ending, NothingScoredIsNotAPerfectScore) {
  int rounds = 0;
  const std::string late = edited_scene({{"settle_s: 2", "settle_s: 15"}});
  const Outcome o = run({"servo", late, "--json", "--quiet", "--out", "run"}, [&](pid_t child) {
    if (fs::exists(folder_ / "run.partial/incomplete") && ++rounds == 5) ::kill(child, SIGINT);
  });
  EXPECT_EQ(o.code, 130) << o.err;
  const json j = json_of(o);
  EXPECT_EQ(j["scored_frames"], 0);
  for (const char* key : {"residual", "motion", "reduction_percent"}) EXPECT_TRUE(j[key].is_null()) << key << j[key];
  for (const char* key : {"rms", "p95", "max"}) EXPECT_TRUE(j["residual_px"][key].is_null()) << key;
}

TEST_F(Ending, TheGuardLeavesAFlightRecording) {
  // slow heart and breath: the tip leaves its workspace later than the 2 s that the recording holds
  const std::string tight =
      edited_scene({{"motion:\n", "motion:\n  heart_rate_hz: 0.6\n  respiration_rate_hz: 0.15\n"},
                    {"loop:\n", "loop:\n  guard: {workspace_radius_m: 0.0075, max_step_m: 0.001}\n"}});
  const Outcome o = run({"servo", tight, "--predictor", "constant_acceleration", "--json", "--out", "run"});
  EXPECT_EQ(o.code, 5) << o.err;
  EXPECT_EQ(o.error_lines(), 1u) << o.err;
  EXPECT_NE(o.err.find("safety stop"), std::string::npos) << o.err;
  EXPECT_NE(o.err.find("flight.csv"), std::string::npos) << o.err;
  const json j = json_of(o);
  EXPECT_EQ(j["commands"]["safety_stops"], 1);
  EXPECT_NE(j["stop_reason"].get<std::string>().find("workspace"), std::string::npos) << j["stop_reason"];
  expect_complete("run");
  const auto flight = tools::TimeTable::read_csv(folder_ / "run/flight.csv");
  const auto all = tools::TimeTable::read_csv(folder_ / "run/frames.csv");
  ASSERT_GT(flight.rows(), 0u);
  EXPECT_EQ(all.rows(), j["frames"].get<std::size_t>());
  EXPECT_EQ(flight.time_s().back(), all.time_s().back());
  EXPECT_NEAR(flight.time_s().back() - flight.time_s().front(), 2, 0.009);
  EXPECT_GT(all.rows(), flight.rows());
}

TEST_F(Ending, AForeignFolderIsLeftAlone) {
  fs::create_directories(folder_ / "mine");
  write_text(folder_ / "mine/notes.txt", "keep");
  write_text(folder_ / "file", "keep");
  for (const char* command : {"servo", "track", "render"}) {
    expect_refused(2, {command, scene("pig_2007"), "--frames", "3", "--quiet", "--out", "mine"}, {"mine", "not a run"});
    expect_refused(2, {command, scene("pig_2007"), "--frames", "3", "--quiet", "--out", "file"},
                   {"file", "not a folder"});
    expect_refused(2, {command, scene("pig_2007"), "--frames", "3", "--quiet", "--out", "file/x"}, {"file"});
  }
  EXPECT_EQ(read_text(folder_ / "mine/notes.txt"), "keep");
  EXPECT_EQ(read_text(folder_ / "file"), "keep");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "mine"), {}), 1);
  EXPECT_FALSE(fs::exists(folder_ / "mine.partial"));
}

TEST_F(Ending, AnEarlierRunIsReplaced) {
  ASSERT_EQ(run({"servo", scene("pig_2007"), "--frames", "3", "--out", "run"}).code, 0);
  write_text(folder_ / "run/old.txt", "old");
  ASSERT_EQ(run({"track", scene("pig_2007"), "--frames", "4", "--out", "run"}).code, 0);
  EXPECT_EQ(summary_of("run")["command"], "track");
  EXPECT_FALSE(fs::exists(folder_ / "run/old.txt"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1) << "nothing beside the run";
}

TEST_F(Ending, APlaceThatCannotBeWrittenIsRefused) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  fs::create_directories(folder_ / "locked");
  fs::permissions(folder_ / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  expect_refused(2, {"servo", scene("pig_2007"), "--frames", "3", "--quiet", "--out", "locked/run"},
                 {"locked", "ermission"});
  fs::permissions(folder_ / "locked", fs::perms::owner_all);
}

TEST_F(Ending, RunsOfTheSameSecondGetFoldersOfTheirOwn) {
  for (int i = 0; i < 3; ++i) ASSERT_EQ(run({"render", scene("pig_2007"), "--frames", "1", "--quiet"}).code, 0);
  int count = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "runs")) {
    ++count;
    EXPECT_EQ(entry.path().filename().string().rfind("render-pig_2007-", 0), 0u) << entry.path();
    expect_complete("runs/" + entry.path().filename().string());
  }
  EXPECT_EQ(count, 3);
}

}  // namespace
}  // namespace heartservo::test
