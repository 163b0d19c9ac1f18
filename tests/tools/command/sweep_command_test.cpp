// `sweep`: resumed, shared, with failures, from the command line.
#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <sstream>

#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

using nlohmann::json;

class SweepCommand : public CommandLine {
 protected:
  std::string sweep(const std::string& axes,
                    const std::string& metrics = "[residual.rms_mm, tracking.lost_frames]") const {
    write_text(folder_ / "sweep.yaml", "title: A test\nscene: " + scene("pig_2007") +
                                           "\nset: {duration_s: 0.24, settle_s: 0.1}\naxes:\n" + axes +
                                           "metrics: " + metrics + "\n");
    return "sweep.yaml";
  }
  // results.csv without the seconds.
  std::string results(const std::string& out) const {
    std::istringstream in(read_text(folder_ / (out + "/results.csv")));
    std::string text, line;
    while (std::getline(in, line)) {
      const auto last = line.find_last_of(',');
      text += line.substr(0, line.find_last_of(',', last - 1)) + "\n";
    }
    return text;
  }
};

TEST_F(SweepCommand, RunsTheProductAndGivesTheSameInShares) {
  const std::string file = sweep("  engines.predictor: [hold, constant_velocity]\n  seed: {from: 1, to: 3}\n");
  EXPECT_EQ(run({"sweep", file, "--count"}).out, "6\n");
  const Outcome whole = run({"sweep", file, "--out", "whole", "--json"});
  ASSERT_EQ(whole.code, 0) << whole.err;
  const json j = json_of(whole);
  EXPECT_EQ(j["done"], 6);
  EXPECT_EQ(j["failed"], 0);
  ASSERT_EQ(j["groups"].size(), 2u);
  EXPECT_EQ(j["groups"][0]["metrics"]["residual.rms_mm"]["runs"], 3);
  EXPECT_EQ(j["pairs"].size(), 1u);
  const std::string table = results("whole");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 7);
  const std::string page = read_text(folder_ / "whole/report.html");
  for (const char* part : {"Pairs on the same seeds", "<canvas id=\"chart0\"", "residual.rms_mm over the seeds"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  ASSERT_EQ(run({"report", "whole", "--out", "again.html", "--quiet"}).code, 0);
  EXPECT_EQ(read_text(folder_ / "again.html"), read_text(folder_ / "whole/report.html"));
  expect_refused(2, {"report", "whole", "whole"}, {"a sweep", "alone"});
  // as a run of its own gives it
  const json alone = json_of(run({"servo", scene("pig_2007"), "--frames", "30", "--settle-s", "0.1", "--predictor",
                                  "hold", "--seed", "2", "--json", "--quiet", "--no-video"}));
  EXPECT_NE(results("whole").find(fmt::format("1,hold,2,done,{},0", alone["residual"]["rms_mm"].get<double>())),
            std::string::npos)
      << results("whole");
  for (const char* share : {"1/2", "2/2"})
    EXPECT_EQ(run({"sweep", file, "--out", "parts", "--share", share, "--quiet"}).code, 0);
  EXPECT_EQ(run({"sweep", file, "--out", "parts", "--merge", "--quiet"}).code, 0);
  EXPECT_EQ(results("parts"), results("whole")) << "bit for bit";
}

TEST_F(SweepCommand, AnInterruptedOneGoesOnWithoutRepeatingARun) {
  const std::string file = sweep("  seed: {from: 1, to: 12}\n");
  int rounds = 0;
  const Outcome o = run({"sweep", file, "--out", "swept", "--jobs", "1", "--quiet"}, [&](pid_t child) {
    const fs::path runs = folder_ / "swept/runs.csv";
    if (fs::exists(runs) && read_text(runs).find("\n1,") != std::string::npos && ++rounds == 1) ::kill(child, SIGINT);
  });
  EXPECT_EQ(o.code, 130) << o.err;
  EXPECT_EQ(run({"sweep", file, "--out", "swept", "--quiet"}).code, 0);
  const std::string runs = read_text(folder_ / "swept/runs.csv");
  EXPECT_EQ(std::count(runs.begin(), runs.end(), '\n'), 13) << "each once";
  EXPECT_EQ(run({"sweep", file, "--out", "swept", "--quiet"}).code, 0);
  EXPECT_EQ(read_text(folder_ / "swept/runs.csv"), runs) << "nothing is left to do";
}

TEST_F(SweepCommand, AFailingRunIsRecordedAndTheRestGoesOn) {
  // a path outside the workspace is only refused when the run begins
  const std::string file = sweep("  loop.guard.max_prediction_s: [0.001, 0.3]\n");
  const Outcome o = run({"sweep", file, "--out", "swept", "--json"});
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(json_of(o)["failed"], 1);
  EXPECT_EQ(json_of(o)["done"], 2);
  EXPECT_NE(read_text(folder_ / "swept/results.csv").find("the run is refused"), std::string::npos);
}

TEST_F(SweepCommand, TwoAtOnceAreRefusedOrTakeTurns) {
  const std::string file = sweep("  seed: {from: 1, to: 8}\n");
  Outcome refused, waited;
  const Outcome first = run({"sweep", file, "--out", "swept", "--jobs", "1", "--quiet"}, [&](pid_t child) {
    if (waited.code >= 0 || !fs::exists(folder_ / "swept/runs.csv")) return;
    ::kill(child, SIGSTOP);  // it is in the middle while the second tries
    refused = run({"sweep", file, "--out", "swept", "--quiet"});
    waited = run({"sweep", file, "--out", "swept", "--quiet", "--wait"}, [&](pid_t) { ::kill(child, SIGCONT); });
  });
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("another heartservo is writing"), std::string::npos) << refused.err;
  EXPECT_EQ(waited.code, 0) << waited.err;
  const std::string runs = read_text(folder_ / "swept/runs.csv");
  EXPECT_EQ(std::count(runs.begin(), runs.end(), '\n'), 9) << "each once";
}

TEST_F(SweepCommand, NoRunOutlivesASweepThatIsKilled) {
  const std::string file = sweep("  seed: {from: 1, to: 200}\n");
  const Outcome o = run({"sweep", file, "--out", "swept", "--quiet"}, [&](pid_t child) {
    if (fs::exists(folder_ / "swept/runs.csv") && read_text(folder_ / "swept/runs.csv").find("\n") != std::string::npos)
      ::kill(child, SIGKILL);
  });
  EXPECT_EQ(o.code, 128 + SIGKILL);
  Outcome next;
  for (int i = 0; i < 20 && next.code != 0; ++i)  // the runs die a moment after it
    next = run({"sweep", file, "--out", "swept", "--merge", "--quiet"});
  EXPECT_EQ(next.code, 0) << "the folder is free: " << next.err;
}

TEST_F(SweepCommand, BadOnesAreRefused) {
  expect_refused(3, {"sweep", "nowhere.yaml"}, {"nowhere.yaml"});
  expect_refused(2, {"sweep", sweep("  engines.predictr: [hold]\n"), "--out", "x"}, {"did you mean 'predictor'"});
  expect_refused(
      2, {"sweep", sweep("  picture.noise_grey: {from: 0, to: 1, steps: 1000}\n  seed: {from: 1, to: 1000000}\n")},
      {"1000000000 runs", "--yes"});
  const std::string file = sweep("  seed: {from: 1, to: 2}\n");
  expect_refused(2, {"sweep", file, "--share", "3/2"}, {"--share"});
  ASSERT_EQ(run({"sweep", file, "--out", "swept", "--quiet"}).code, 0);
  expect_refused(2, {"sweep", sweep("  seed: {from: 7, to: 9}\n"), "--out", "swept"}, {"another sweep"});
}

TEST_F(SweepCommand, ShippedSweepsAreGood) {
  for (const char* name : {"latency", "control", "robustness", "arrhythmia", "readme"}) {
    const Outcome o = run({"sweep", HEARTSERVO_SOURCE_DIR "/scenes/sweeps/" + std::string(name) + ".yaml", "--count"});
    EXPECT_EQ(o.code, 0) << o.err;
    EXPECT_GT(std::stoi(o.out), 30) << name;
  }
}

}  // namespace
}  // namespace heartservo::test
