// heartservo analyse and heartservo beats, as a user calls them.
#include <random>

#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

using nlohmann::json;

class Analyse : public CommandLine {
 protected:
  // Breathing of 0.25 Hz and a heart of 1.25 Hz, 20 s at 50 rows a second; `row` edits a row's text.
  std::string motion(const std::function<std::string(int, const std::string&)>& row = {}) const {
    std::mt19937_64 random(5);
    std::normal_distribution<double> noise(0, 1e-5);
    std::string text = "time_s,measured/x_m,measured/y_m,measured/z_m,truth/x_m,truth/y_m,truth/z_m\n";
    for (int i = 0; i < 1000; ++i) {
      const double t = 0.02 * i, breath = std::sin(2 * M_PI * 0.25 * t), beat = std::sin(2 * M_PI * 1.25 * t);
      const double p[] = {1e-3 * breath + 2e-3 * beat, 1e-3 * beat, 0.05 + 3e-3 * breath + 1e-3 * beat};
      std::string line = std::to_string(t);
      for (const double v : p) line += "," + std::to_string(v + noise(random));
      for (const double v : p) line += "," + std::to_string(v);
      text += (row ? row(i, line) : line) + "\n";
    }
    write_text(folder_ / "motion.csv", text);
    return "motion.csv";
  }
};

TEST_F(Analyse, SummaryRunFolderAndTables) {
  const Outcome o = run({"analyse", motion(), "--out", "run"});
  EXPECT_EQ(o.code, 0) << o.err;
  for (const char* part : {"heart 1", "respiration 1", "cut-off Hz", "largest acceleration", "report: "})
    EXPECT_NE(o.out.find(part), std::string::npos) << part << "\n" << o.out;
  expect_complete("run");
  const json j = summary_of("run");
  EXPECT_EQ(j["command"], "analyse");
  EXPECT_EQ(j["points"], "measured");
  EXPECT_NEAR(j["heart_hz"], 1.25, 0.003);
  EXPECT_NEAR(j["respiration_hz"], 0.25, 0.003);
  EXPECT_EQ(j["split_hz"], 1);
  EXPECT_NEAR(j["axes"]["z"]["respiration_peak_to_peak_mm"], 6, 0.1);
  EXPECT_NEAR(j["axes"]["z"]["beat_peak_to_peak_mm"], 2, 0.1);
  const double acceleration = 2e-3 * std::pow(2 * M_PI * 1.25, 2);
  EXPECT_NEAR(j["axes"]["x"]["max_acceleration_m_s2"], acceleration + 1e-3 * std::pow(2 * M_PI * 0.25, 2),
              0.1 * acceleration);
  EXPECT_GT(j["axes"]["x"]["acceleration_sigma_m_s2"], 0);
  EXPECT_NEAR(j["truth"]["heart_hz"], 1.25, 0.003);
  for (const json& line : j["lines"])
    if (line["name"] == "heart 1") {
      EXPECT_NEAR(line["density_percent"]["x"], 80, 0.5);
    }
  EXPECT_NE(read_text(folder_ / "run/motion.csv").find("respiration/z_m"), std::string::npos);
  EXPECT_NE(read_text(folder_ / "run/spectrum.csv").find("frequency_hz,density/x_m2_hz"), std::string::npos);
  EXPECT_NE(read_text(folder_ / "run/report.html").find("Power spectral density"), std::string::npos);
}

TEST_F(Analyse, WhatTrackWritesCanBeAnalysed) {
  EXPECT_EQ(run({"track", scene("pig_2007"), "--frames", "1260", "--out", "tracked", "--quiet"}).code, 0);
  const json j = json_of(run({"analyse", "tracked", "--json", "--cutoff-hz", "10"}));
  EXPECT_NEAR(j["heart_hz"], 1.19, 0.03);
  EXPECT_EQ(j["axes"]["z"]["cutoff_hz"], 10);
  EXPECT_NEAR(j["truth"]["heart_hz"], j["heart_hz"], 0.01);
  const json tum = json_of(run({"analyse", "tracked/trajectory_esm.tum", "--json", "--cutoff-hz", "10"}));
  EXPECT_NEAR(tum["heart_hz"], j["heart_hz"].get<double>(), 1e-3);
}

TEST_F(Analyse, BadInputIsOneLineWithItsPlace) {
  expect_refused(2, {"analyse"}, {"MOTION is missing"});
  expect_refused(2, {"analyse", motion(), "--point", "measured"}, {"'--point'", "did you mean '--points'"});
  expect_refused(2, {"analyse", motion(), "--points", "mesured"}, {"did you mean 'measured'"});
  expect_refused(2, {"analyse", motion(), "--cutoff-hz", "30"}, {"30 Hz is too high"});
  expect_refused(2, {"analyse", motion(), "--cutoff-hz", "nan"}, {"--cutoff-hz"});
  expect_refused(3, {"analyse", "nowhere.csv"}, {"nowhere.csv: cannot be read"});
  expect_refused(3, {"analyse", "."}, {"frames.csv"});
  const auto refused = [&](const std::function<std::string(int, const std::string&)>& row, const std::string& part) {
    expect_refused(3, {"analyse", motion(row), "--out", "bad"}, {part});
    EXPECT_FALSE(fs::exists(folder_ / "bad"));
  };
  refused([](int i, const std::string& line) { return i == 7 ? "0.01,1,2,3,1,2,3" : line; },
          "motion.csv:9: time 0.01 s after 0.12 s");
  refused([](int i, const std::string& line) { return i == 7 ? line + ",1" : line; }, "motion.csv:9: 8 cells");
  refused(
      [](int i, const std::string& line) {
        return i > 99 && i < 200 ? line.substr(0, line.find(',')) + ",,,,1,2,3" : line;
      },
      "motion.csv:202: 2.02 s without a position");
  refused([](int i,
             const std::string& line) { return line.substr(0, line.find(',')) + ",1,2,3,1,2,3" + (i < 0 ? "" : ""); },
          "motion.csv:2: the position is the same in every row");
}

TEST_F(Analyse, GapsAreNoted) {
  const json j = json_of(run({"analyse", motion([](int i, const std::string& line) {
                                return i > 99 && i < 105 ? line.substr(0, line.find(',')) + ",,,,1,2,3" : line;
                              }),
                              "--json"}));
  EXPECT_EQ(j["interpolated_rows"], 5);
  ASSERT_FALSE(j["notes"].empty());
  EXPECT_NE(j["notes"][0].get<std::string>().find("motion.csv:102"), std::string::npos) << j["notes"];
}

class Beats : public CommandLine {
 protected:
  // A spike a second, for 20 s at 200 samples a second.
  std::string ecg() const {
    std::string text = "time_s,II\n";
    for (int i = 0; i < 4000; ++i) {
      const double t = 0.005 * i, since = t - std::round(t);
      text += std::to_string(t) + "," + std::to_string(std::exp(-0.5 * since * since / 1e-4)) + "\n";
    }
    write_text(folder_ / "ecg.csv", text);
    return "ecg.csv";
  }
};

TEST_F(Beats, AFileOfBeatsAndTheirScore) {
  std::string labels = "time_s\n";
  for (int i = 1; i < 20; ++i) labels += std::to_string(i) + "\n";
  write_text(folder_ / "labels.csv", labels);
  const Outcome o = run({"beats", ecg(), "--labels", "labels.csv", "--out", "run"});
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_NE(o.out.find("sensitivity"), std::string::npos);
  expect_complete("run");
  const json j = summary_of("run");
  EXPECT_EQ(j["lead"], "II");
  EXPECT_NEAR(j["interval_ms"]["mean"], 1000, 1);
  EXPECT_EQ(j["score"]["matched"], 19);
  EXPECT_EQ(j["score"]["sensitivity_percent"], 100);
  EXPECT_LT(j["delay_ms"], 140);
  EXPECT_EQ(read_text(folder_ / "run/beats.csv").rfind("time_s,known_s,looked_back\n", 0), 0U);
}

TEST_F(Beats, BadInput) {
  expect_refused(2, {"beats"}, {"ECG is missing"});
  expect_refused(3, {"beats", "none.hea"}, {"none.hea: cannot be read"});
  expect_refused(2, {"beats", ecg(), "--lead", "I"}, {"no lead 'I'", "it has II"});
  expect_refused(3, {"beats", ecg(), "--labels", "none.atr"}, {"none.atr: cannot be read"});
  expect_refused(2, {"beats", ecg(), "--lable", "x"}, {"did you mean '--labels'"});
}

TEST_F(Beats, RenderWritesThoseOfTheHeartAndTheEcg) {
  EXPECT_EQ(run({"render", scene("ecg_simulated"), "--frames", "250", "--out", "rendered", "--quiet"}).code, 0);
  EXPECT_EQ(read_text(folder_ / "rendered/beats.csv").rfind("time_s\n", 0), 0U);
  const json j = json_of(run({"beats", "rendered/ecg.csv", "--labels", "rendered/beats.csv", "--json"}));
  EXPECT_GE(j["beats"], 5) << "2 s, and 5 s before";
  EXPECT_GE(j["score"]["sensitivity_percent"], 50) << "the last one may not be known yet";
}

}  // namespace
}  // namespace heartservo::test
