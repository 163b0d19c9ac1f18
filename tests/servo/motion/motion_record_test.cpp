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
    return message_of<InputError>([&] { read_motion(file(text, name)); });
  }
  static constexpr const char* kHead = "time_s,measured/x_m,measured/y_m,measured/z_m\n";
  test::TemporaryFolder folder_;
};

TEST_F(ReadMotion, MeasuredAndTruth) {
  const auto r =
      read_motion(file("truth/z_m,time_s,measured/x_m,measured/y_m,other,measured/z_m,truth/x_m,truth/y_m\n"
                       "0.6,0,0.1,0.2,word,0.3,0.4,0.5\n"
                       "1.6,0.5,1.1,1.2,word,1.3,1.4,1.5\n"));
  EXPECT_EQ(r.group, "measured");
  EXPECT_EQ(r.time_s, (std::vector<double>{0, 0.5}));
  EXPECT_EQ(r.line, (std::vector<int>{2, 3}));
  EXPECT_EQ(r.position[1], Eigen::Vector3d(1.1, 1.2, 1.3));
  EXPECT_EQ(r.truth[0], Eigen::Vector3d(0.4, 0.5, 0.6));
  EXPECT_EQ(r.period_s, 0.5);
  EXPECT_TRUE(r.notes.empty());
}

TEST_F(ReadMotion, AGroupOfSeveral) {
  const auto path = file("time_s,p0/x_m,p0/y_m,p0/z_m,p1/x_m,p1/y_m,p1/z_m\n0,1,2,3,4,5,6\n1,2,3,4,5,6,7\n");
  EXPECT_EQ(read_motion(path, "p1").position[0], Eigen::Vector3d(4, 5, 6));
  EXPECT_FALSE(read_motion(path, "p1").has_truth());
  EXPECT_NE(message_of<ConfigError>([&] { read_motion(path); }).find("--points p0|p1"), std::string::npos);
  EXPECT_NE(message_of<ConfigError>([&] { read_motion(path, "q1"); }).find("did you mean 'p"), std::string::npos);
  EXPECT_NE(message_of<ConfigError>([&] { read_motion(path, "truth"); }).find("p0, p1"), std::string::npos);
}

TEST_F(ReadMotion, TruthAloneIsAMotionToo) {
  const auto r = read_motion(file("time_s,truth/x_m,truth/y_m,truth/z_m\n0,1,2,3\n1,2,3,4\n"));
  EXPECT_EQ(r.group, "truth");
  EXPECT_FALSE(r.has_truth());
}

TEST_F(ReadMotion, WhatIsOddIsNoted) {
  std::string text = kHead;
  for (int i = 0; i < 10; ++i)
    text += std::to_string(0.1 * i) + "," + std::to_string(i * i) + ",7," + std::to_string(i) + "\n";
  text += "1.4,1,7,2\n1.5,,,\n1.6,nan,nan,nan\n1.7,1,7,\n1.8,1,7,2\n";
  const auto r = read_motion(file(text));
  ASSERT_EQ(r.notes.size(), 3U);
  EXPECT_NE(r.notes[0].find("motion.csv:12: a gap of 0.5 s"), std::string::npos) << r.notes[0];
  EXPECT_NE(r.notes[1].find("motion.csv:13: no position in 3 rows"), std::string::npos) << r.notes[1];
  EXPECT_NE(r.notes[2].find("y is 7 m in every row"), std::string::npos) << r.notes[2];
  EXPECT_EQ(r.rows(), 15U);
  EXPECT_TRUE(r.position[13].array().isNaN().all()) << "a position is known wholly or not at all";
}

TEST_F(ReadMotion, ManyOddPlacesAreCounted) {
  std::string text = kHead;
  for (int i = 0; i < 20; ++i) text += std::to_string(i) + (i % 2 ? ",,,\n" : ",1,2," + std::to_string(i) + "\n");
  const auto notes = read_motion(file(text)).notes;
  ASSERT_EQ(notes.size(), 6U);  // three places, one that counts, two axes
  EXPECT_NE(notes[3].find("7 more"), std::string::npos);
}

TEST_F(ReadMotion, BadFilesAreRefusedByLine) {
  const std::string head = kHead;
  const auto says = [&](const std::string& text, const std::string& part) {
    const std::string message = refused(text);
    EXPECT_NE(message.find(part), std::string::npos) << text << "\n" << message;
  };
  says("", "motion.csv:1: is empty");
  says("time,measured/x_m,measured/y_m,measured/z_m\n", "motion.csv:1: column time_s is missing");
  says("time_s,measured/x_m,measured/y_m,measured/zm\n0,1,2,3\n",
       "motion.csv:1: column measured/z_m is missing (did you mean 'measured/zm'?)");
  says("time_s,x,y,z\n0,1,2,3\n", "column measured/x_m is missing");
  says("time_s,measured/x_m,measured/x_m,measured/y_m,measured/z_m\n", "measured/x_m is there twice");
  says("time_s,measured/x_m,measured/y_m,measured/z_m,truth/x_m\n0,1,2,3,4\n", "column truth/y_m is missing");
  says(head + "0,1,2,3\n0.1,1,2\n", "motion.csv:3: 3 cells under 4 columns");
  says(head + "0,1,2,3\n0.1,1,2,left\n", "motion.csv:3: 'left' under measured/z_m is not a number");
  says(head + "0,1,2,3\n0.2,1,2,3\n0.1,1,2,3\n", "motion.csv:4: time 0.1 s comes after 0.2 s in line 3");
  says(head + "0,1,2,3\n0,1,2,3\n", "motion.csv:3: time 0 s comes after 0 s");
  says(head + "0,1,2,3\n,1,2,3\n", "motion.csv:3: the time is missing");
  says(head + "0,1,2,3\n1,1,inf,3\n", "motion.csv:3: a position must be finite");
  says(head, "has no rows");
  says(head + "0,1,2,3\n", "has one row, in line 2");
  says(head + "0,1,2,3\n1,,,\n", "only 1 of 2 rows have a position");
  EXPECT_NE(message_of<InputError>([&] { read_motion(folder_ / "none.csv"); }).find("cannot be read"),
            std::string::npos);
  EXPECT_NE(message_of<InputError>([&] { read_motion(folder_.path()); }).find("no frames.csv"), std::string::npos);
}

TEST_F(ReadMotion, TumTrajectoriesAndRunFolders) {
  const auto r = read_motion(file("# time x y z q\n0 1 2 3 0 0 0 1\n0.04 2 3 4 0 0 0 1\n", "a.tum"));
  EXPECT_EQ(r.position[1], Eigen::Vector3d(2, 3, 4));
  EXPECT_EQ(r.line, (std::vector<int>{2, 3}));
  EXPECT_NE(refused("0 1 2 3 0 0 0 1\n0.04 2 3 4 0 0 0\n", "a.tum").find("a.tum:2: expected"), std::string::npos);
  EXPECT_NE(refused("0 1 2 3 0 0 0 1\n0.04 2 x 4 0 0 0 1\n", "a.tum").find("a.tum:2: expected"), std::string::npos);
  EXPECT_NE(refused("0 1 2 3 0 0 0 1\n0 2 2 4 0 0 0 1\n", "a.tum").find("a.tum:2: time 0 s"), std::string::npos);
  file(std::string(kHead) + "0,1,2,3\n1,2,3,4\n", "frames.csv");
  EXPECT_EQ(read_motion(folder_.path()).file, folder_ / "frames.csv");
}

TEST_F(ReadMotion, Beats) {
  EXPECT_EQ(read_beats(file("time_s\n0.5\n1.25\n")), (std::vector<double>{0.5, 1.25}));
  const auto says = [&](const std::string& text) { return message_of<InputError>([&] { read_beats(file(text)); }); };
  EXPECT_NE(says("time_s\n1\n0.5\n").find("motion.csv:3: beat at 0.5 s comes after 1 s"), std::string::npos);
  EXPECT_NE(says("time_s\n1\n\"\"\n").find("motion.csv:3: the time is missing"), std::string::npos);
  EXPECT_NE(says("times\n1\n").find("did you mean 'times'"), std::string::npos);
  EXPECT_NE(says("time_s\n").find("no beats"), std::string::npos);
}

}  // namespace
}  // namespace heartservo::servo
