#include "servo/motion/motion_record.hpp"

#include <gtest/gtest.h>

#include "tests/support/files.hpp"
#include "tests/support/message.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::servo {
namespace {

using test::message_of;

class ReadMotion : public testing::Test {
 protected:
  std::string file(const std::string& text, const std::string& name = "motion.csv") const {
    return folder_.write(name, text);
  }
  // The message with which `text` is refused.
  std::string refused(const std::string& text, const std::string& name = "motion.csv") const {
    return message_of<InputError>([&] { read_motion_record(file(text, name)); });
  }
  static constexpr const char* kHead = "time_s,measured/x_m,measured/y_m,measured/z_m\n";
  test::TemporaryFolder folder_;
};

TEST_F(ReadMotion, MeasuredAndTruth) {
  const auto r =
      read_motion_record(file("truth/z_m,time_s,measured/x_m,measured/y_m,other,measured/z_m,truth/x_m,truth/y_m\n"
                              "0.6,0,0.1,0.2,word,0.3,0.4,0.5\n"
                              "1.6,0.5,1.1,1.2,word,1.3,1.4,1.5\n"));
  EXPECT_EQ(r.group, "measured");
  EXPECT_EQ(r.time_s, (std::vector<double>{0, 0.5}));
  EXPECT_EQ(r.line, (std::vector<int>{2, 3}));
  EXPECT_EQ(r.measured[1], Eigen::Vector3d(1.1, 1.2, 1.3));
  EXPECT_EQ(r.truth[0], Eigen::Vector3d(0.4, 0.5, 0.6));
  EXPECT_EQ(r.period_s(), 0.5);
  EXPECT_TRUE(r.warnings.empty());
}

TEST_F(ReadMotion, AGroupOfSeveral) {
  const auto path = file("time_s,p0/x_m,p0/y_m,p0/z_m,p1/x_m,p1/y_m,p1/z_m\n0,1,2,3,4,5,6\n1,2,3,4,5,6,7\n");
  EXPECT_EQ(read_motion_record(path, "p1").measured[0], Eigen::Vector3d(4, 5, 6));
  EXPECT_TRUE(read_motion_record(path, "p1").truth.empty());
  EXPECT_NE(message_of<ConfigError>([&] { read_motion_record(path); }).find("--points: p0, p1"), std::string::npos);
  EXPECT_NE(message_of<ConfigError>([&] { read_motion_record(path, "q1"); }).find("did you mean 'p"),
            std::string::npos);
  EXPECT_NE(message_of<ConfigError>([&] { read_motion_record(path, "truth"); }).find("p0, p1"), std::string::npos);
}

TEST_F(ReadMotion, TruthAloneIsAMotionToo) {
  const auto r = read_motion_record(file("time_s,truth/x_m,truth/y_m,truth/z_m\n0,1,2,3\n1,2,3,4\n"));
  EXPECT_EQ(r.group, "truth");
  EXPECT_TRUE(r.truth.empty());
}

TEST_F(ReadMotion, WhatIsOddIsNoted) {
  std::string text = kHead;
  for (int i = 0; i < 10; ++i)
    text += std::to_string(0.1 * i) + "," + std::to_string(i * i) + ",7," + std::to_string(i) + "\n";
  text += "1.4,1,7,2\n1.5,,,\n1.6,nan,nan,nan\n1.7,1,7,2\n";
  const auto r = read_motion_record(file(text));
  ASSERT_EQ(r.warnings.size(), 3U);
  EXPECT_NE(r.warnings[0].find("motion.csv:12: 0.5 s without a row"), std::string::npos) << r.warnings[0];
  EXPECT_NE(r.warnings[1].find("motion.csv:13: no position, as in 1 more rows"), std::string::npos) << r.warnings[1];
  EXPECT_NE(r.warnings[2].find("y is 7 in every row"), std::string::npos) << r.warnings[2];
  EXPECT_EQ(r.measured.size(), 14U);
  EXPECT_TRUE(r.measured[12].hasNaN());
}

TEST_F(ReadMotion, BadFilesAreRefusedByLine) {
  const std::string head = kHead;
  const auto says = [&](const std::string& text, const std::string& part) {
    const std::string message = refused(text);
    EXPECT_NE(message.find(part), std::string::npos) << text << "\n" << message;
  };
  says("", "motion.csv:1: is empty");
  says("time,measured/x_m,measured/y_m,measured/z_m\n", "motion.csv:1: there is no column time_s; 'time' is not it");
  says("time_s,measured/x_m,measured/y_m,measured/zm\n0,1,2,3\n",
       "motion.csv:1: there is no column measured/z_m (did you mean 'measured/zm'?)");
  says("time_s,x,y,z\n0,1,2,3\n", "motion.csv:1: no column has a position");
  says("time_s,measured/x_m,measured/x_m,measured/y_m,measured/z_m\n", "measured/x_m is there twice");
  says("time_s,measured/x_m,measured/y_m,measured/z_m,truth/x_m\n0,1,2,3,4\n", "there is no column truth/y_m");
  says(head + "0,1,2,3\n0.1,1,2\n", "motion.csv:3: 3 cells under 4 columns");
  says(head + "0,1,2,3\n0.1,1,2,left\n", "motion.csv:3: 'left' under measured/z_m is not a number");
  says(head + "0,1,2,3\n0.2,1,2,3\n0.1,1,2,3\n", "motion.csv:4: time 0.1 s after 0.2 s");
  says(head + "0,1,2,3\n0,1,2,3\n", "motion.csv:3: time 0 s after 0 s");
  says(head + "0,1,2,3\n,1,2,3\n", "motion.csv:3: time_s must be a time");
  says(head + "0,1,2,3\n1,1,inf,3\n", "motion.csv:3: a position is infinite");
  says(head, "motion.csv: 0 rows");
  says(head + "0,1,2,3\n", "motion.csv:2: 1 row of positions");
  says(head + "0,1,2,3\n1,1,,3\n", "motion.csv:3: only part of a position");
  says(head + "0,,,\n1,,,\n", "motion.csv:2: no row has a position");
  EXPECT_NE(message_of<InputError>([&] { read_motion_record(folder_ / "none.csv"); }).find("cannot be read"),
            std::string::npos);
  EXPECT_NE(message_of<InputError>([&] { read_motion_record(folder_.path()); }).find("no frames.csv"),
            std::string::npos);
}

TEST_F(ReadMotion, TumTrajectoriesAndRunFolders) {
  const auto r = read_motion_record(file("# time x y z q\n0 1 2 3 0 0 0 1\n0.04 2 3 4 0 0 0 1\n", "a.tum"));
  EXPECT_EQ(r.measured[1], Eigen::Vector3d(2, 3, 4));
  EXPECT_EQ(r.line, (std::vector<int>{2, 3}));
  EXPECT_NE(refused("0 1 2 3 0 0 0 1\n0.04 2 3 4 0 0 0\n", "a.tum").find("a.tum:2: expected"), std::string::npos);
  EXPECT_NE(refused("0 1 2 3 0 0 0 1\n0.04 2 x 4 0 0 0 1\n", "a.tum").find("a.tum:2: expected"), std::string::npos);
  EXPECT_NE(refused("0 1 2 3 0 0 0 1\n0 2 2 4 0 0 0 1\n", "a.tum").find("a.tum:2: time 0 s"), std::string::npos);
  file(std::string(kHead) + "0,1,2,3\n1,2,3,4\n", "frames.csv");
  EXPECT_EQ(read_motion_record(folder_.path()).file, folder_ / "frames.csv");
}

TEST_F(ReadMotion, Beats) {
  EXPECT_EQ(read_beats(file("time_s\n0.5\n1.25\n")), (std::vector<double>{0.5, 1.25}));
  const auto says = [&](const std::string& text) { return message_of<InputError>([&] { read_beats(file(text)); }); };
  EXPECT_NE(says("time_s\n1\n0.5\n").find("motion.csv:3: time 0.5 s after 1 s"), std::string::npos);
  EXPECT_NE(says("time_s\n1\n\"\"\n").find("motion.csv:3: time_s must be a time"), std::string::npos);
  EXPECT_NE(says("times\n1\n").find("motion.csv:1: there is no column time_s"), std::string::npos);
  EXPECT_NE(says("time_s\n").find("no beats"), std::string::npos);
}

}  // namespace
}  // namespace heartservo::servo
