#include <fstream>

#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

class PredictCommand : public CommandLine {
 protected:
  // Two harmonics and breathing, 125 Hz.
  void write_motion(int rows, bool truth) const {
    std::string text = "time_s,measured/x_m,measured/y_m,measured/z_m";
    text += truth ? ",truth/x_m,truth/y_m,truth/z_m\n" : "\n";
    for (int k = 0; k < rows; ++k) {
      const double t = 0.008 * k, x = 3e-3 * std::sin(7.5 * t) + 1e-3 * std::cos(15 * t), z = 4e-3 * std::sin(2.1 * t);
      const std::string p = std::to_string(x) + "," + std::to_string(0.5 * x) + "," + std::to_string(z);
      text += std::to_string(t) + "," + p + (truth ? "," + p : "") + "\n";
    }
    write_text(folder_ / "motion.csv", text);
  }
};

TEST_F(PredictCommand, SummaryHasTheContractsKeys) {
  write_motion(1500, true);
  write_text(folder_ / "beats.csv", "time_s\n0.1\n0.94\n1.78\n2.61\n3.45\n");
  const Outcome o = run({"predict", "motion.csv", "--predictor", "hold,mixture", "--horizons-ms", "64,16", "--settle-s",
                         "8", "--beats", "beats.csv", "--out", "run", "--json"});
  ASSERT_EQ(o.code, 0) << o.err;
  const auto j = nlohmann::json::parse(o.out);
  EXPECT_EQ(j["command"], "predict");
  EXPECT_EQ(j["reference"], "truth");
  ASSERT_EQ(j["predictors"].size(), 2u);
  const auto& hold = j["predictors"][0];
  EXPECT_EQ(hold["name"], "hold");
  EXPECT_EQ(hold["unlocks"], 0);
  ASSERT_EQ(hold["horizons"].size(), 2u);
  EXPECT_EQ(hold["horizons"][0]["ms"], 16.0);
  for (const char* axis : {"x", "y", "z", "norm"}) EXPECT_GT(hold["horizons"][1]["rms_mm"][axis], 0.1) << axis;
  EXPECT_GE(hold["horizons"][1]["max_mm"], hold["horizons"][1]["p99_mm"]);
  EXPECT_LT(j["predictors"][1]["horizons"][1]["rms_mm"]["norm"], hold["horizons"][1]["rms_mm"]["norm"]);
  for (const char* name : {"summary.json", "frames.csv", "report.html", "config.yaml"})
    EXPECT_TRUE(fs::exists(folder_ / (std::string("run/") + name))) << name;
}

TEST_F(PredictCommand, ShortRecordsAreScoredAfterAThird) {
  write_motion(600, false);
  const Outcome o = run({"predict", "motion.csv", "--predictor", "hold", "--out", "run"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_NE(o.out.find("3D RMS"), std::string::npos) << o.out;
  EXPECT_NE(o.out.find("scored on the measurement after 1.6 s"), std::string::npos) << o.out;
}

TEST_F(PredictCommand, BadInputIsRefused) {
  write_motion(50, false);
  expect_refused(3, {"predict", "none.csv"}, {"none.csv"});
  expect_refused(2, {"predict"}, {"MOTION.csv is missing"});
  expect_refused(2, {"predict", "motion.csv", "--predictor", "mixtur"}, {"'mixtur'", "did you mean 'mixture'"});
  expect_refused(2, {"predict", "motion.csv", "--predictor", "hold,hold"}, {"given twice"});
  expect_refused(2, {"predict", "motion.csv", "--points", "point3"}, {"no points 'point3'", "measured"});
  expect_refused(2, {"predict", "motion.csv", "--settle-s", "30"}, {"nothing is left to be scored"});
  expect_refused(2, {"predict", "motion.csv", "--horizons-ms", "16,nan"}, {"horizons-ms"});
  expect_refused(2, {"predict", "motion.csv", "--horizon-ms", "16"}, {"did you mean '--horizons-ms'"});
  write_text(folder_ / "beats.csv", "time_s\n0.5\n0.2\n");
  expect_refused(3, {"predict", "motion.csv", "--beats", "beats.csv"}, {"beats.csv:3", "time must go on"});
  write_text(folder_ / "motion.csv", "time_s,measured/x_m,measured/y_m,measured/z_m\n0,0,0,0\n0.1,0,0,0\n0.05,0,0,0\n");
  expect_refused(3, {"predict", "motion.csv"}, {"motion.csv:4", "time must go on"});
  EXPECT_FALSE(fs::exists(folder_ / "runs")) << "nothing half-written";
}

TEST_F(PredictCommand, ListsThePredictors) {
  const Outcome o = run({"predict", "--list"});
  EXPECT_EQ(o.code, 0);
  for (const char* name : {"hold ", "constant_velocity ", "autoregressive ", "harmonic ", "harmonic_ecg ", "mixture "})
    EXPECT_NE(o.out.find(name), std::string::npos) << name;
}

}  // namespace
}  // namespace heartservo::test
