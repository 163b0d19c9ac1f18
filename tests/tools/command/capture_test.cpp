// heartservo capture on a machine without a camera, and what it refuses. With real drivers: tests/vm.
#include "tests/tools/command/command_fixture.hpp"
#include "tools/capture/picture_writer.hpp"
#include "tools/capture/recorder.hpp"

namespace heartservo::test {
namespace {

class Capture : public CommandLine {
 protected:
  static bool has_device() {
    for (const auto& entry : fs::directory_iterator("/dev"))
      if (entry.path().filename().string().rfind("video", 0) == 0) return true;
    return false;
  }
};

TEST_F(Capture, AListOfNoDevicesSaysSo) {
  if (has_device()) GTEST_SKIP() << "this machine has a video device";
  const Outcome o = run({"capture", "--list"});
  EXPECT_EQ(o.code, 0);
  EXPECT_EQ(o.out.substr(0, 15), "no video device");
  EXPECT_EQ(o.err, "");
  const auto json = json_of(run({"capture", "--list", "--json"}));
  EXPECT_EQ(json["devices"].size(), 0u);
}

TEST_F(Capture, RefusesWithOneLine) {
  expect_refused(4, {"capture", "/dev/video97"},
                 {"/dev/video97: cannot be opened: No such file or directory", "--list"});
  expect_refused(4, {"capture", "--probe", "v4l2:/dev/video97,size=640x480"}, {"/dev/video97"});
  expect_refused(4, {"track", "v4l2:/dev/video97"}, {"/dev/video97: cannot be opened"});
  expect_refused(4, {"servo", "v4l2:/dev/video97"}, {"/dev/video97: cannot be opened"});
  expect_refused(4, {"capture", "/dev/null"}, {"/dev/null: cannot be opened"});
  write_text(folder_ / "file.txt", "no camera");
  expect_refused(4, {"capture", "file.txt"}, {"file.txt: cannot be opened", "is it a video device?"});
  expect_refused(2, {"capture"}, {"DEVICE is missing"});
  expect_refused(2, {"capture", "/dev/video97,size=huge"}, {"size=huge is no such value", "size=640x480"});
  expect_refused(2, {"capture", "/dev/video97", "--lst"}, {"did you mean '--list'"});
  expect_refused(2, {"servo", "v4l2:/dev/video97", "--predictor", "hold,mixture"}, {"frames come only once"});
  EXPECT_FALSE(fs::exists(folder_ / "runs"));
}

TEST_F(Capture, NoWindowWithoutADisplay) {
  const char* display = std::getenv("DISPLAY");
  if (display != nullptr && *display != '\0') GTEST_SKIP() << "there is a display";
  sequence("frames", 3);
  expect_refused(4, {"track", "frames", "--show"}, {"--show: there is no display"});
}

TEST_F(Capture, ARecordingIsASource) {
  fs::create_directories(folder_ / "recorded");
  {
    tools::Recorder recorder(folder_ / "recorded", tools::write_ffv1(folder_ / "recorded", {160, 120}, false, 40), {});
    for (int i = 0; i < 20; ++i) {
      tracking::Frame frame;
      frame.grey = waves(0.5 * i);
      frame.time_s = 0.025 * i + (i > 9 ? 0.1 : 0);
      frame.sequence = static_cast<std::uint64_t>(i);
      frame.capture.emplace();
      recorder.offer(frame);
    }
  }
  const auto json = json_of(run({"track", "recorded", "--roi", "50,40,50,50", "--json", "--out", "run"}));
  EXPECT_EQ(json["frames"], 20);
  EXPECT_EQ(json["trackers"][0]["lost_frames"], 0);
  EXPECT_NEAR(json["trackers"][0]["displacement_px"]["x"]["max"].get<double>(), 9.5, 0.1);
  const std::string csv = read_text(folder_ / "run/frames.csv");
  EXPECT_NE(csv.find("\n0.35,10,"), std::string::npos) << "its own time stamps";
}

}  // namespace
}  // namespace heartservo::test
