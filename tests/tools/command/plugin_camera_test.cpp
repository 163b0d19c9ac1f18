// A camera that only libv4l2 can convert, made by a plugin of it; the plugin's folder is mounted over libv4l2's own, in a
// mount namespace of its own.
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
  std::string where_;
};

TEST_F(PluginCamera, BayerIsConvertedByLibv4l2) {
  const Outcome o = with_plugin("capture camera,frozen-s=0 --frames 10 --json --out recording");
  ASSERT_EQ(o.code, 0) << o.err;
  const auto json = json_of(o);
  EXPECT_EQ(json["recorded"]["frames"], 10);
  EXPECT_EQ(json["card"], "Bayer camera");
  EXPECT_EQ(json["granted"]["format"].get<std::string>().substr(0, 12), "YU12 320x240");
  const auto source = tracking::open_source(folder_ / "recording", 0);
  tracking::Frame frame;
  ASSERT_TRUE(source->next(frame));
  const cv::Scalar is = cv::mean(frame.colour(cv::Rect(40, 40, 240, 160)));
  const double wanted[] = {40, 90, 160};
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(is[i], wanted[i], 8) << i;
}

TEST_F(PluginCamera, AFrozenPictureIsNoLivePicture) {
  const auto json = json_of(with_plugin("capture camera,frozen-s=0.2 --seconds 1 --json --out recording"));
  EXPECT_EQ(json["event_counts"]["frozen_picture"], 1);
}

TEST_F(PluginCamera, TheLoopRunsOnIt) {
  const Outcome o = with_plugin("servo v4l2:camera,frozen-s=0 --frames 20 --roi 100,100,40,40 --json --out run");
  // a picture without texture cannot be followed; the reason is said
  EXPECT_EQ(o.code, 2) << o.err;
  EXPECT_NE(o.err.find("cannot be tracked"), std::string::npos) << o.err;
}

}  // namespace
}  // namespace heartservo::test
