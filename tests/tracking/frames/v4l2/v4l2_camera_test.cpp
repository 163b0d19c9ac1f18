// The camera with its own thread, on a scripted device that runs in real time.
#include "tracking/frames/v4l2/v4l2_camera.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/support/message.hpp"
#include "tests/tracking/frames/v4l2/fake_driver.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/frames/open_source.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::test {
namespace {

using namespace tracking;
using namespace tracking::v4l2;

class V4l2CameraTest : public testing::Test {
 protected:
  V4l2CameraTest() {
    options.device = "/dev/video0";
    driver.real_time = true;
    driver.rate_hz = 100;
  }
  FakeDriver driver;
  CameraOptions options;
};

TEST_F(V4l2CameraTest, ASlowConsumerGetsTheNewestFrame) {
  const auto camera = open_v4l2_camera(options, false, driver);
  EXPECT_EQ(camera->size(), cv::Size(64, 48));
  EXPECT_EQ(camera->frame_rate_hz(), 100);
  EXPECT_EQ(camera->live(), camera.get());
  Frame frame;
  std::uint64_t last = 0, skipped = 0;
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(camera->next(frame));
    ASSERT_EQ(frame.status, FrameStatus::OK) << frame.note;
    if (i > 0) {
      EXPECT_EQ(frame.sequence, last + 1 + frame.capture->skipped + frame.capture->missing);
    }
    last = frame.sequence;
    skipped += frame.capture->skipped;
    const double begin = driver.now_s();
    while (driver.now_s() < begin + 0.035) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_GT(skipped, 10u);
  EXPECT_GE(camera->report().skipped, skipped);
}

TEST_F(V4l2CameraTest, EveryFrameIsKeptForASlowConsumer) {
  options.every_frame = true;
  const auto camera = open_v4l2_camera(options, false, driver);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  Frame frame;
  for (std::uint64_t i = 0; i < 15; ++i) {
    ASSERT_TRUE(camera->wait_for(frame, 1));
    EXPECT_EQ(frame.sequence, i);
  }
  EXPECT_EQ(camera->report().queue_dropped, 0u);
}

TEST_F(V4l2CameraTest, WithoutFramesNextGoesOnAndSaysWhy) {
  options.give_up_s = 0.6;
  const auto camera = open_v4l2_camera(options, false, driver);
  Frame frame;
  double last = -1;
  bool seen = false, ended = false;
  driver.at(driver.now_s() - 1000 + 0.1, [](auto& d) { d.plugged = d.node = false; });
  for (int i = 0; i < 200 && !ended; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    ended = !camera->next(frame);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(600));
    EXPECT_GT(frame.time_s, last - ended);
    last = frame.time_s;
    seen |= frame.status == FrameStatus::UNREADABLE && frame.note.find("unplugged") != std::string::npos;
  }
  EXPECT_TRUE(seen);
  EXPECT_TRUE(ended);
  EXPECT_NE(camera->failure().find("did not come back"), std::string::npos) << camera->failure();
}

TEST_F(V4l2CameraTest, ACameraWithoutSignalIsRefusedWithTheReason) {
  driver.dv = true;
  driver.real_time = false;
  driver.signal_error = ENOLINK;
  const std::string why = message_of<DeviceError>([&] { open_v4l2_camera(options, false, driver); });
  EXPECT_NE(why.find("no live picture within 5 s (no_signal"), std::string::npos) << why;
}

TEST(OpenSource, ADeviceThatIsNotThere) {
  const std::string why = message_of<DeviceError>([] { open_source("v4l2:/dev/video97", 0); });
  EXPECT_NE(why.find("/dev/video97: cannot be opened: No such file or directory"), std::string::npos) << why;
  EXPECT_NE(message_of<DeviceError>([] { open_source("v4l2:/dev/null", 0); }), "nothing was thrown");
}

}  // namespace
}  // namespace heartservo::test
