// Frames from disk, whole and broken, and regions that cannot be followed.
#include <opencv2/imgproc.hpp>

#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

using nlohmann::json;

class RecordedFrames : public CommandLine {
 protected:
  // Follows the middle of `source` with both commands.
  void expect_lost(const std::string& source, int lost, int count) const {
    const Outcome servo = run({"servo", source, "--roi", "50,30,40,40", "--json", "--quiet", "--out", "run"});
    EXPECT_EQ(servo.code, 0) << servo.err;
    EXPECT_EQ(servo.err, "");
    EXPECT_EQ(json_of(servo)["frames"], count);
    EXPECT_EQ(json_of(servo)["tracking"]["lost_frames"], lost);
    EXPECT_EQ(json_of(servo)["tracking"]["unreadable_frames"], lost);
    expect_complete("run");
    const Outcome track = run({"track", source, "--roi", "50,30,40,40", "--json", "--quiet", "--out", "run"});
    EXPECT_EQ(track.code, 0) << track.err;
    EXPECT_EQ(json_of(track)["frames"], count);
    EXPECT_EQ(json_of(track)["trackers"][0]["lost_frames"], lost);
  }
  void expect_region_refused(const std::string& source, const std::string& roi, const std::string& reason) const {
    for (const char* command : {"servo", "track"}) expect_refused(2, {command, source, "--roi=" + roi}, {reason});
  }
};

TEST_F(RecordedFrames, FollowsAWholeSequence) {
  const std::string source = sequence("frames", 12);
  expect_lost(source, 0, 12);
  const json j = json_of(run({"track", source, "--roi", "50,30,40,40", "--json"}));
  EXPECT_NEAR(j["trackers"][0]["displacement_px"]["x"]["max"], 5.5, 0.3) << "half a pixel a frame to the right";
  EXPECT_TRUE(j["trackers"][0]["error_px"].is_null());
  const json shorter = json_of(run({"track", source, "--roi", "50,30,40,40", "--frames", "4", "--json"}));
  EXPECT_EQ(shorter["frames"], 4);
}

TEST_F(RecordedFrames, NothingToReadIsSaid) {
  fs::create_directories(folder_ / "empty");
  fs::create_directories(folder_ / "text");
  write_text(folder_ / "text/note.png", "this is no picture\n");
  for (const char* command : {"servo", "track"}) {
    expect_refused(3, {command, "nowhere"}, {"nowhere", "no such"});
    expect_refused(3, {command, "empty"}, {"empty", "no pictures"});
    expect_refused(3, {command, "text"}, {"note.png", "text file"});
  }
}

TEST_F(RecordedFrames, OnePictureIsARunOfOneFrame) {
  const std::string source = sequence("one", 1);
  for (const char* command : {"servo", "track"}) {
    const Outcome o = run({command, source, "--roi", "50,30,40,40", "--json", "--quiet", "--out", "run"});
    EXPECT_EQ(o.code, 0) << o.err;
    EXPECT_EQ(json_of(o)["frames"], 1);
    EXPECT_EQ(o.out.find("nan"), std::string::npos) << o.out;
    expect_complete("run");
  }
}

TEST_F(RecordedFrames, ATruncatedPictureIsOneLostFrame) {
  const std::string source = sequence("frames", 9);
  const std::string whole = read_text(picture(source, 4));
  write_text(picture(source, 4), whole.substr(0, whole.size() / 2));
  expect_lost(source, 1, 9);
}

TEST_F(RecordedFrames, APictureOfAnotherSizeIsOneLostFrame) {
  const std::string source = sequence("frames", 9);
  cv::imwrite(picture(source, 5), waves(0, {80, 60}));
  expect_lost(source, 1, 9);
}

TEST_F(RecordedFrames, APictureOfAnotherTypeIsReadAsGrey) {
  const std::string source = sequence("frames", 9);
  cv::Mat deep, colour;
  waves(2.5).convertTo(deep, CV_16U, 257);
  cv::imwrite(picture(source, 5), deep);
  cv::cvtColor(waves(3), colour, cv::COLOR_GRAY2BGR);
  cv::imwrite(picture(source, 6), colour);
  expect_lost(source, 0, 9);
}

TEST_F(RecordedFrames, ATextAmongPicturesIsOneLostFrame) {
  const std::string source = sequence("frames", 9);
  write_text(picture(source, 5), "this is no picture\n");
  expect_lost(source, 1, 9);
}

TEST_F(RecordedFrames, ABrokenFirstPictureIsUnreadableInput) {
  const std::string source = sequence("frames", 3);
  write_text(picture(source, 0), read_text(picture(source, 0)).substr(0, 200));
  for (const char* command : {"servo", "track"})
    expect_refused(3, {command, source, "--roi", "50,30,40,40"}, {"00.png", "cut off", "first frame"});
}

TEST_F(RecordedFrames, RegionsThatCannotBeFollowedAreRefusedWithTheReason) {
  const std::string source = sequence("frames", 3);
  expect_region_refused(source, "140,30,40,40", "outside the picture of 160 x 120 px");
  expect_region_refused(source, "-5,30,40,40", "outside the picture");
  expect_region_refused(source, "50,30,8,8", "smaller than 12 px");
  expect_region_refused(source, "50,30,0,40", "width and a height above 0");
  expect_region_refused(source, "50,30,40", "--roi");
  expect_region_refused(source, "50,30,40,40,5", "--roi");
  expect_region_refused(source, "50,nan,40,40", "'nan'");
  expect_region_refused(source, "50,x,40,40", "'x'");
  fs::create_directories(folder_ / "flat");
  for (int i = 0; i < 3; ++i) cv::imwrite(picture("flat", i), cv::Mat(120, 160, CV_8UC1, cv::Scalar(90)));
  expect_region_refused("flat", "50,30,40,40", "too little texture");
  // an edge that can slide along itself
  fs::create_directories(folder_ / "stripes");
  cv::Mat stripes(120, 160, CV_8UC1);
  for (int u = 0; u < stripes.cols; ++u) stripes.col(u).setTo(128 + 60 * std::sin(u / 4.0));
  for (int i = 0; i < 3; ++i) cv::imwrite(picture("stripes", i), stripes);
  expect_region_refused("stripes", "50,30,40,40", "condition number");
  expect_refused(2, {"track", source, "--corners", "50,30,50,70,90,70,90,30"}, {"clockwise"});
  expect_refused(2, {"track", source, "--corners", "50,30,90,30,90,nan,50,70"}, {"--corners", "'nan'"});
  expect_refused(2, {"track", source, "--corners", "50,30,90,30,70,40,50,70"}, {"clockwise"});
  expect_refused(2, {"track", source, "--corners", "50,30,58,30,58,70,50,70"}, {"smaller than 12 px"});
  expect_refused(2, {"track", source, "--corners", "50,30,170,30,170,70,50,70"}, {"outside the picture"});
  expect_refused(2, {"track", source, "--square-mm", "5"}, {"--camera"});
  expect_refused(2, {"servo", scene("pig_2007"), "--roi", "50,30,40,40"}, {"--roi"});
}

TEST_F(RecordedFrames, RenderedFramesAreTrackedAgainstTheirTruth) {
  ASSERT_EQ(run({"render", scene("pig_2007"), "--frames", frames(100), "--out", "rendered"}).code, 0);
  const std::string truth = read_text(folder_ / "rendered/truth.csv");
  const auto row = truth.find('\n') + 1, first = truth.find(',', row) + 1;
  std::size_t end = first;
  for (int i = 0; i < 8; ++i) end = truth.find(',', end) + 1;
  const std::string corners = truth.substr(first, end - first - 1);
  const Outcome o = run({"track", "rendered/frames", "--truth", "rendered/truth.csv", "--corners", corners, "--camera",
                         "rendered/camera.yaml", "--square-mm", "5", "--json", "--out", "run"});
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_EQ(o.err, "");
  const json lane = json_of(o)["trackers"][0];
  EXPECT_EQ(lane["lost_frames"], 0);
  ASSERT_FALSE(lane["error_px"].is_null());
  EXPECT_LT(lane["error_px"]["mean"], 0.2);
  const std::string tum = read_text(folder_ / "run/trajectory_esm.tum");
  EXPECT_EQ(std::count(tum.begin(), tum.end(), '\n'), std::stoi(frames(100)));
  const std::string line = tum.substr(0, tum.find('\n'));
  EXPECT_EQ(std::count(line.begin(), line.end(), ' '), 7) << line;
  const Outcome other = run({"track", "rendered/frames", "--truth", "rendered/truth.csv", "--corners", corners,
                             "--frame-rate-hz", "0.37", "--frames", "2", "--json", "--out", "other"});
  EXPECT_LE(json_of(other)["trackers"][0]["error_px"]["mean"], 0.2) << "only the frame at 0 s has a row";
}

TEST_F(RecordedFrames, FollowsARealHeart) {
  const fs::path heart = recorded_data() / "heart_invivo/left";
  if (!fs::exists(heart)) GTEST_SKIP() << "no " << heart << "; set HEARTSERVO_DATA to the recorded data";
  const Outcome o = run({"servo", heart, "--roi", "150,130,60,60", "--frames", "40", "--json", "--out", "run"});
  ASSERT_EQ(o.code, 0) << o.err;
  const json j = json_of(o);
  EXPECT_EQ(j["frames"], 40);
  EXPECT_GT(j["scored_frames"], 0);
  EXPECT_EQ(j["residual_px"]["reference"], "tracked");
  EXPECT_TRUE(j["residual_px"]["rms"].is_number());
  EXPECT_TRUE(j["residual"].is_null());
  EXPECT_LE(j["tracking"]["lost_frames"], 2);
  const std::string csv = read_text(folder_ / "run/frames.csv");
  EXPECT_NE(csv.find(",track/state,"), std::string::npos);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 41);
}

}  // namespace
}  // namespace heartservo::test
