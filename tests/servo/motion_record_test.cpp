#include <gtest/gtest.h>

#include <cmath>

#include "servo/motion/motion_record.hpp"
#include "servo/motion/prediction_score.hpp"
#include "servo/prediction/registry.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::servo {
namespace {

constexpr const char* kHeader = "time_s,measured/x_m,measured/y_m,measured/z_m\n";

class MotionRecords : public testing::Test {
 protected:
  std::string file(const std::string& text) const {
    const std::string path = folder_ / "motion.csv";
    std::ofstream(path) << text;
    return path;
  }
  std::string refusal(const std::string& text, const std::string& group = "") const {
    return test::message_of<InputError>([&] { read_motion_record(file(text), group); });
  }
  test::TemporaryFolder folder_;
};

TEST_F(MotionRecords, BadInputIsNamedByLine) {
  const std::string rows = "0,1,2,3\n0.1,1,2,3\n";
  const auto expect = [&](const std::string& text, const std::string& line, const std::string& what) {
    const std::string message = refusal(text);
    EXPECT_NE(message.find("motion.csv:" + line + ":"), std::string::npos) << message;
    EXPECT_NE(message.find(what), std::string::npos) << message;
  };
  expect(kHeader + rows + "0.05,1,2,3\n", "4", "time 0.05 s after 0.1 s");
  expect(kHeader + rows + "0.1,1,2,3\n", "4", "time must go on");
  expect(kHeader + rows + "nan,1,2,3\n", "4", "time_s must be a time");
  expect(kHeader + rows + "0.2,1,,3\n", "4", "only part of a position");
  expect(kHeader + rows + "0.2,inf,2,3\n", "4", "infinite");
  expect(kHeader + rows + "0.2,1,2\n", "4", "3 cells under 4 columns");
  expect(kHeader + rows + "0.2,one,2,3\n", "4", "'one' under measured/x_m is not a number");
  expect(std::string(kHeader) + "0,1,2,3\n", "2", "1 row of positions");
  expect(std::string(kHeader) + "0,,,\n1,,,\n", "2", "no row has a position");
  expect("", "1", "is empty");
  expect("time,measured/x_m,measured/y_m,measured/z_m\n" + rows, "1", "'time' is not it");
  expect("time_s,measured/x_m,measured/y_m,mesured/z_m\n" + rows, "1", "did you mean 'mesured/z_m'");
  expect("time_s,a,b,c\n" + rows, "1", "no column has a position");
}

TEST_F(MotionRecords, OddButUsableInputIsWarnedOf) {
  const MotionRecord record =
      read_motion_record(file(std::string(kHeader) + "0,1,2,3\n0.1,2,2,4\n0.2,,,\n0.3,1,2,3\n0.9,1,2,3\n"));
  ASSERT_EQ(record.warnings.size(), 3u);
  EXPECT_NE(record.warnings[0].find(":6: 0.6"), std::string::npos) << record.warnings[0];
  EXPECT_NE(record.warnings[1].find(":4: no position"), std::string::npos) << record.warnings[1];
  EXPECT_NE(record.warnings[2].find("y is 2 in every row"), std::string::npos) << record.warnings[2];
  EXPECT_NEAR(record.period_s(), 0.1, 1e-12);
}

TEST_F(MotionRecords, GroupsOfPointsAreChosenByName) {
  const std::string text = "time_s,p0/x_m,p0/y_m,p0/z_m,p1/x_m,p1/y_m,p1/z_m\n0,1,2,3,4,5,6\n1,1,2,3,4,5,7\n";
  EXPECT_EQ(read_motion_record(file(text), "p1").measured[1], Eigen::Vector3d(4, 5, 7));
  const std::string several = test::message_of<ConfigError>([&] { read_motion_record(file(text)); });
  EXPECT_NE(several.find("choose one with --points: p0, p1"), std::string::npos) << several;
  const std::string unknown = test::message_of<ConfigError>([&] { read_motion_record(file(text), "p3"); });
  EXPECT_NE(unknown.find("did you mean"), std::string::npos) << unknown;
}

TEST_F(MotionRecords, ScoreOfHoldIsTheDisplacement) {
  std::string text = kHeader;
  for (int k = 0; k < 100; ++k) text += std::to_string(0.01 * k) + "," + std::to_string(0.001 * k) + ",0,0\n";
  const MotionRecord record = read_motion_record(file(text));
  const auto hold = predictors().make("hold", PredictorOptions{});
  const PredictionScore score = score_predictor(record, {{0.02, 0.055}, 0.2, {}}, *hold);
  EXPECT_NEAR(score.horizons[0].rms_m, 0.002, 1e-9);
  EXPECT_NEAR(score.horizons[1].rms_m, 0.0055, 1e-9) << "between rows the line between them";
  EXPECT_EQ(score.horizons[0].axis_rms_m.y(), 0);
  EXPECT_EQ(score.horizons[0].scored, 78u);
  EXPECT_EQ(score.unlocks, 0);
}

TEST_F(MotionRecords, PredictorsSeeNothingOfTheFuture) {
  std::string text = kHeader, changed;
  for (int k = 0; k < 1500; ++k) {
    if (k == 1000) changed = text;
    const double t = 0.008 * k;
    text += std::to_string(t) + "," + std::to_string(3e-3 * std::sin(7 * t)) + "," +
            std::to_string(2e-3 * std::sin(14 * t)) + "," + std::to_string(5e-3 * std::sin(2 * t)) + "\n";
  }
  for (int k = 1000; k < 1500; ++k) changed += std::to_string(0.008 * k) + ",0.1,0.1,0.1\n";
  const MotionRecord a = read_motion_record(file(text)), b = read_motion_record(file(changed));
  for (const auto& name : predictors().names()) {
    std::vector<Eigen::Vector3d> seen;
    const auto run = [&](const MotionRecord& record, const auto& look) {
      const auto predictor = predictors().make(name, PredictorOptions{});
      score_predictor(record, {{0.016}, 0, {0.5, 1.3, 2.2, 3.1, 4, 4.9}}, *predictor,
                      [&](std::size_t row, std::size_t, const Prediction& p, const Eigen::Vector3d&) {
                        if (row < 1000) look(row, p.position);
                      });
    };
    run(a, [&](std::size_t, const Eigen::Vector3d& p) { seen.push_back(p); });
    run(b, [&](std::size_t row, const Eigen::Vector3d& p) { ASSERT_EQ(p, seen[row]) << name << " at row " << row; });
  }
}

}  // namespace
}  // namespace heartservo::servo
