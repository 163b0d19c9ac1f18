// A camera that only libv4l2 can convert, made by a plugin of it; the plugin's folder is mounted over libv4l2's own, in
// a mount namespace of its own.
#include "tests/tools/command/command_fixture.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/frames/open_source.hpp"

namespace heartservo::test {
namespace {

class PluginCamera : public CommandLine {
 protected:
  void SetUp() override {
#ifdef HEARTSERVO_SANITIZED
    GTEST_SKIP() << "the plugin is not built for sanitizers";
#endif
    fs::create_directories(folder_ / "plugins");
    fs::copy_file(HEARTSERVO_BAYER_CAMERA, folder_ / "plugins/libv4l-bayer.so");
    write_text(folder_ / "camera", "BAYERCAM");
    for (const auto& entry : fs::directory_iterator("/usr/lib"))
      if (fs::exists(entry.path() / "libv4l/plugins")) where_ = entry.path() / "libv4l/plugins";
    if (where_.empty()) GTEST_SKIP() << "libv4l2 has no folder for plugins";
    if (run_process({"unshare", "-m", "mount", "--bind", folder_ / "plugins", where_}, folder_.path()).code != 0)
      GTEST_SKIP() << "needs a mount namespace, which is not permitted here";
  }
  Outcome with_plugin(const std::string& arguments) const {
    const std::string text = "mount --bind plugins '" + where_ + "' && exec '" + HEARTSERVO_PROGRAM + "' " + arguments;
    return run_process({"unshare", "-m", "sh", "-c", text}, folder_.path(), {}, 60);
  }
  // Ctrl-C a while after `sign` is there.
  Outcome interrupted(const std::string& arguments, const std::string& sign) const {
    const std::string text = "mount --bind plugins '" + where_ + "' && exec '" + HEARTSERVO_PROGRAM + "' " + arguments;
    return run_process({"unshare", "-m", "sh", "-c", text}, folder_.path(), [&](pid_t process) {
      if (fs::exists(folder_ / sign) && !fs::exists(folder_ / "told")) {
        write_text(folder_ / "told", "");
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        ::kill(process, SIGINT);
      }
    });
  }
  std::string where_;
};

TEST_F(PluginCamera, BayerIsConvertedByLibv4l2) {
  const Outcome o = with_plugin("capture camera --frames 10 --json --out recording");
  ASSERT_EQ(o.code, 0) << o.err;
  const auto json = json_of(o);
  EXPECT_EQ(json["recorded"]["frames"], 10);
  EXPECT_EQ(json["card"], "Bayer camera");
  EXPECT_EQ(json["granted"]["format"].get<std::string>().substr(0, 12), "YU12 320x240");
  const auto source = tracking::open_source(folder_ / "recording", 0);
  tracking::Frame frame;
  ASSERT_TRUE(source->next(frame));
  const cv::Scalar is = cv::mean(frame.colour(cv::Rect(40, 40, 240, 160)));
  const double wanted[] = {60, 90, 160};
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(is[i], wanted[i], 10) << i;
}

TEST_F(PluginCamera, AFrozenPictureIsNamed) {
  write_text(folder_ / "camera", "BAYERCAM still");
  const auto json = json_of(with_plugin("capture camera,frozen-s=0.2 --seconds 1 --json --out recording"));
  EXPECT_EQ(json["event_counts"]["frozen_picture"], 1);
}

TEST_F(PluginCamera, ItsPicturesAreTracked) {
  const auto json =
      json_of(with_plugin("track v4l2:camera,frames=every --frames 40 --roi 120,90,60,60 --json --out run"));
  EXPECT_EQ(json["frames"], 40);
  const auto& frames = json["capture"]["frames"];
  if (frames["missing"] == 0 && frames["queue_dropped"] == 0) {  // a machine that is too busy loses frames
    EXPECT_EQ(json["trackers"][0]["lost_frames"], 0);
    EXPECT_NEAR(json["trackers"][0]["displacement_px"]["x"]["max"].get<double>(), 19.5, 0.5);
  }
  EXPECT_NE(read_text(folder_ / "run/frames.csv").find("frame/age_s"), std::string::npos);
}

TEST_F(PluginCamera, TheLoopRunsOnItInRealTime) {
  const Outcome o =
      with_plugin("servo v4l2:camera --frames 40 --settle-s 0 --roi 120,90,60,60 --real-time --json --out run");
  ASSERT_EQ(o.code, 0) << o.err;
  const auto json = json_of(o);
  EXPECT_EQ(json["frames"], 40);
  EXPECT_GT(json["live"]["age_ms"]["p50"], 0);
  EXPECT_GT(json["live"]["glass_to_command_ms"]["p50"], json["live"]["age_ms"]["min"]);
  EXPECT_EQ(json["live"]["real_time"]["wanted"], true);
  EXPECT_NEAR(json["frame_rate_hz"].get<double>(), 50, 10) << "measured: the device does not say it";
  EXPECT_GE(json["live"]["period_ms"]["max"], json["live"]["period_ms"]["p50"]);
  const std::string csv = read_text(folder_ / "run/frames.csv");
  for (const char* column : {"frame/age_s", "command/glass_to_command_s", "capture/device_s", "capture/decoded_s"})
    EXPECT_NE(csv.find(column), std::string::npos) << column;
}

TEST_F(PluginCamera, CtrlCEndsALoopCleanly) {
  const Outcome o = interrupted("servo v4l2:camera --settle-s 0 --roi 120,90,60,60 --quiet --out run", "run.partial");
  EXPECT_EQ(o.code, 130) << o.err;
  expect_complete("run");
  EXPECT_EQ(summary_of("run")["interrupted"], true);
}

TEST_F(PluginCamera, CtrlCEndsARecordingCleanly) {
  const Outcome o = interrupted("capture camera --quiet --out run", "run.partial/frames.csv");
  EXPECT_EQ(o.code, 130) << o.err;
  EXPECT_EQ(o.err, "");
  const auto recorded = summary_of("run")["recorded"];
  EXPECT_EQ(recorded["interrupted"], true);
  EXPECT_GT(recorded["frames"], 0);
  const std::string rows = read_text(folder_ / "run/frames.csv");
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 1 + recorded["frames"].get<int>());
}

}  // namespace
}  // namespace heartservo::test
