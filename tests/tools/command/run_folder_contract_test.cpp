// What a run leaves behind: the documented files, the keys of summary.json, the columns of frames.csv.
#include <fmt/format.h>

#include <set>
#include <sstream>

#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

using nlohmann::json;

class RunFolderContract : public CommandLine {
 protected:
  static void expect_numbers(const json& j, const std::vector<std::string>& pointers) {
    for (const auto& name : pointers) {
      const json::json_pointer pointer(name);
      ASSERT_TRUE(j.contains(pointer)) << name;
      EXPECT_TRUE(j[pointer].is_number()) << name << " is " << j[pointer];
    }
  }
  static void expect_texts(const json& j, const std::vector<std::string>& pointers) {
    for (const auto& name : pointers) {
      const json::json_pointer pointer(name);
      ASSERT_TRUE(j.contains(pointer)) << name;
      EXPECT_TRUE(j[pointer].is_string() && !j[pointer].get<std::string>().empty()) << name << " is " << j[pointer];
    }
  }

  // time_s first and increasing; every other name ends in a unit or is a known pure number; every row is full.
  void expect_good_csv(const std::string& file, std::size_t rows) const {
    std::istringstream in(read_text(folder_ / file));
    std::string line, cell;
    ASSERT_TRUE(std::getline(in, line)) << file;
    EXPECT_EQ(line.rfind("time_s,", 0), 0u) << line;
    const auto columns = std::count(line.begin(), line.end(), ',');
    std::istringstream names(line);
    while (std::getline(names, cell, ',')) {
      const std::string last = cell.substr(cell.find_last_of('/') + 1), unit = last.substr(last.find('_') + 1);
      static const std::set<std::string> units{"s", "m", "px", "m_s", "ms", "grey", "n"};
      static const std::set<std::string> pure{"sequence",   "status", "state",   "quality",    "gain",
                                              "iterations", "mode",   "limited", "not_finite", "qx",
                                              "qy",         "qz",     "qw",      "stale",      "implausible"};
      EXPECT_TRUE(pure.count(last) || units.count(unit) || cell == "command/acts_at_s") << cell << " shows no unit";
    }
    double before = -1;
    std::size_t count = 0;
    for (; std::getline(in, line); ++count) {
      EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns) << file << ", row " << count;
      const double time = std::stod(line);
      EXPECT_GT(time, before);
      before = time;
    }
    EXPECT_EQ(count, rows) << file;
  }
};

TEST_F(RunFolderContract, Servo) {
  const std::string count = frames(375);
  const Outcome o = run({"servo", scene("pig_2007"), "--frames", count, "--json", "--quiet", "--out", "run"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(o.err, "");
  const json j = json_of(o);
  EXPECT_EQ(j, summary_of("run"));
  expect_complete("run");
  expect_good_csv("run/frames.csv", std::stoul(count));
  EXPECT_EQ(j["command"], "servo");
  EXPECT_EQ(j["scene"], "pig_2007");
  EXPECT_EQ(j["residual_px"]["reference"], "truth");
  EXPECT_EQ(j["frames"], std::stoi(count));
  expect_texts(j, {"/version", "/tracker", "/predictor", "/controller", "/robot"});
  expect_numbers(j,
                 {"/seed", "/frame_rate_hz", "/latency_ms", "/settle_s", "/motion/rms_mm", "/motion/peak_to_peak_mm/x",
                  "/motion/peak_to_peak_mm/y", "/motion/peak_to_peak_mm/z", "/residual/rms_mm", "/residual/p95_mm",
                  "/residual/max_mm", "/residual/axis_rms_mm/x", "/residual/axis_rms_mm/y", "/residual/axis_rms_mm/z",
                  "/reduction_percent", "/residual_px/rms", "/residual_px/p95", "/residual_px/max"});
  expect_numbers(
      j, {"/tracking/lost_frames", "/tracking/uncertain_frames", "/tracking/relocks", "/tracking/error_px/mean",
          "/tracking/error_px/std", "/tracking/error_px/max", "/commands/max_speed_mm_s", "/commands/max_step_mm",
          "/commands/safety_stops", "/timing/real_time_factor"});
  for (const std::string axis : {"x", "y", "z"})
    expect_numbers(j, {"/tracking/position_error_mm/" + axis + "/std", "/tracking/position_error_mm/" + axis + "/max"});
  for (const std::string part : {"track_ms", "chain_ms"})
    expect_numbers(j, {"/timing/" + part + "/p50", "/timing/" + part + "/p99", "/timing/" + part + "/max"});
  EXPECT_GT(j["reduction_percent"], 50) << "the loop must work at all";
  EXPECT_LT(j["tracking"]["error_px"]["mean"], 0.3);
}

TEST_F(RunFolderContract, Track) {
  const std::string count = frames(125);
  const Outcome o = run({"track", scene("pig_2007"), "--frames", count, "--json", "--out", "run"});
  ASSERT_EQ(o.code, 0) << o.err;
  const json j = json_of(o);
  EXPECT_EQ(j, summary_of("run"));
  expect_complete("run");
  expect_good_csv("run/frames.csv", std::stoul(count));
  EXPECT_EQ(j["command"], "track");
  EXPECT_EQ(j["frames"], std::stoi(count));
  expect_texts(j, {"/source", "/trackers/0/name"});
  expect_numbers(
      j, {"/trackers/0/lost_frames", "/trackers/0/uncertain_frames", "/trackers/0/error_px/mean",
          "/trackers/0/error_px/std", "/trackers/0/error_px/max", "/trackers/0/ms/p50", "/trackers/0/ms/p99",
          "/trackers/0/displacement_px/x/rms", "/trackers/0/wrong_ok_frames", "/trackers/0/wrong_over_px/corners",
          "/trackers/0/wrong_over_px/point", "/trackers/0/score_lost_frames", "/trackers/0/relocks"});
  EXPECT_EQ(j["reference"], "truth");
  EXPECT_EQ(j["point"], "target");
  const json& point = j["trackers"][0]["point_error_px"];
  EXPECT_EQ(point["name"], "target");
  EXPECT_EQ(point["frames"], std::stoi(count));
  for (const char* key : {"median", "p95", "mean", "std", "max"}) EXPECT_LT(point[key], 0.2) << key;
  EXPECT_TRUE(j["trackers"][0]["first_failure"].is_null());
  EXPECT_FALSE(j.contains("paper"));
  const std::string csv = read_text(folder_ / "run/frames.csv");
  for (const char* column : {"target/u_px", "displacement/v_px", "error_px", "truth/corner3/v_px", "truth/point/u_px",
                             "point/error_px", "pose/qw", "measured/z_m"})
    EXPECT_NE(csv.substr(0, csv.find('\n')).find(std::string(",") + column), std::string::npos) << column;
}

TEST_F(RunFolderContract, TrackOfThePapersSequences) {
  const std::vector<std::string> table5{"track", "--artificial", "table5", "--tracker", "esm,ssd", "--frames", "25"};
  auto line = table5;
  line.insert(line.end(), {"--json", "--out", "run"});
  const Outcome o = run(line);
  ASSERT_EQ(o.code, 0) << o.err;
  const json j = json_of(o);
  ASSERT_EQ(j["paper"].size(), 1u);
  EXPECT_EQ(j["paper"][0]["what"], "table 5");
  ASSERT_EQ(j["paper"][0]["rows"].size(), 5u);
  const json& ssd = j["paper"][0]["rows"][1];
  EXPECT_EQ(ssd["tracker"], "ssd");
  EXPECT_EQ(ssd["paper_px"]["std"], 0.19);
  EXPECT_EQ(ssd["here_px"], j["trackers"][1]["error_px"]);
  EXPECT_TRUE(j["paper"][0]["rows"][2]["here_px"].is_null()) << "optical_flow was not asked for";
  EXPECT_NE(read_text(folder_ / "run/report.html").find("Table 5 of the paper"), std::string::npos);
  EXPECT_LE(j["trackers"][0]["error_px"]["mean"], 0.02) << "the goal for esm";
  EXPECT_LE(j["trackers"][0]["error_px"]["std"], 0.03);
  const Outcome text = run(table5);
  for (const char* part : {"Table 5 of the paper", "paper mean", "Optical flow", "0.73", "Ours differ because"})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << "\n" << text.out;
  const Outcome circle = run({"track", "--artificial", "circle", "--speculars", "20", "--frames", "25"});
  for (const char* part : {"Fig. 7 of the paper", "loses the pattern", "not run", "20 moving speculars"})
    EXPECT_NE(circle.out.find(part), std::string::npos) << part << "\n" << circle.out;
}

TEST_F(RunFolderContract, Render) {
  const Outcome o = run({"render", scene("pig_2007"), "--frames", "5", "--json", "--out", "run"});
  ASSERT_EQ(o.code, 0) << o.err;
  const json j = json_of(o);
  EXPECT_EQ(j, summary_of("run"));
  expect_complete("run");
  expect_good_csv("run/truth.csv", 5);
  EXPECT_EQ(j["command"], "render");
  EXPECT_EQ(j["frames"], 5);
  expect_numbers(j, {"/seed", "/frame_rate_hz", "/width", "/height"});
  EXPECT_GT(read_text(folder_ / "run/camera.yaml").size(), 50u);
  for (int i = 0; i < 5; ++i) {
    const cv::Mat picture = cv::imread(folder_ / fmt::format("run/frames/{:06d}.png", i), cv::IMREAD_UNCHANGED);
    EXPECT_EQ(picture.cols, j["width"].get<int>());
    EXPECT_EQ(picture.type(), CV_8UC1);
  }
}

TEST_F(RunFolderContract, OneFrameAndTwoAreEnough) {
  for (const char* command : {"servo", "track", "render"})
    for (const char* count : {"1", "2"}) {
      const Outcome o = run({command, scene("pig_2007"), "--frames", count, "--json", "--quiet", "--out", "run"});
      EXPECT_EQ(o.code, 0) << command << count << o.err;
      EXPECT_EQ(o.err, "");
      EXPECT_EQ(json_of(o)["frames"], std::stoi(count)) << command;
      expect_complete("run");
    }
  const Outcome o = run({"servo", scene("pig_2007"), "--frames", "1", "--json", "--quiet", "--out", "run"});
  const json j = json_of(o);
  EXPECT_EQ(j["scored_frames"], 1);
  EXPECT_TRUE(j["reduction_percent"].is_null()) << "one frame shows no motion to cancel";
  expect_numbers(j, {"/residual/rms_mm", "/motion/rms_mm", "/residual_px/rms"});
}

TEST_F(RunFolderContract, AShortRunIsScoredAndSaysFromWhere) {
  const Outcome o = run({"servo", scene("pig_2007"), "--frames", "51", "--json", "--out", "run"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_NE(o.err.find("settle_s"), std::string::npos) << o.err;
  const json j = json_of(o);
  EXPECT_NEAR(j["settle_s"], 0.2, 1e-12);
  EXPECT_EQ(j["scored_frames"], 26);
}

TEST_F(RunFolderContract, TheResolvedConfigurationRunsAgain) {
  ASSERT_EQ(run({"servo", scene("pig_2007"), "--frames", "25", "--seed", "7", "--out", "first"}).code, 0);
  const Outcome again = run({"servo", "first/config.yaml", "--quiet", "--out", "second"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(read_text(folder_ / "second/config.yaml"), read_text(folder_ / "first/config.yaml"));
  EXPECT_EQ(summary_of("second")["residual"], summary_of("first")["residual"]);
}

}  // namespace
}  // namespace heartservo::test
