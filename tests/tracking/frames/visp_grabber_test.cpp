// The adapter for any vpFrameGrabber, on ViSP's own reader of pictures and on a grabber that fails.
#include "tracking/frames/visp_grabber.hpp"

#include <gtest/gtest.h>
#include <visp3/core/vpException.h>
#include <visp3/core/vpFrameGrabber.h>
#include <visp3/io/vpDiskGrabber.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/support/message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::test {
namespace {

using namespace tracking;

cv::Mat picture(int i) {
  cv::Mat bgr(40, 60, CV_8UC3);
  cv::RNG random(static_cast<std::uint64_t>(i + 1));
  random.fill(bgr, cv::RNG::UNIFORM, 0, 256);
  return bgr;
}

TEST(VispGrabber, ReadsWhatADiskGrabberReads) {
  const TemporaryFolder folder;
  for (int i = 0; i < 5; ++i) cv::imwrite(folder / ("img" + std::to_string(i) + ".png"), picture(i));
  for (const bool colour : {false, true}) {
    vpDiskGrabber grabber((folder / "img%d.png").string());
    grabber.setImageNumber(0);
    VispGrabberOptions options;
    options.colour = colour;
    options.frame_count = 5;
    options.frame_rate_hz = 50;
    const auto frames = frames_of(grabber, options);
    EXPECT_EQ(frames->size(), cv::Size(60, 40));
    EXPECT_EQ(frames->frame_count(), 5u);
    Frame frame;
    std::vector<cv::Mat> kept;
    for (int i = 0; i < 5; ++i) {
      ASSERT_TRUE(frames->next(frame));
      ASSERT_EQ(frame.status, FrameStatus::OK) << frame.note;
      EXPECT_EQ(frame.time_s, 0.02 * i);
      EXPECT_EQ(frame.sequence, static_cast<std::uint64_t>(i));
      if (colour) {
        EXPECT_EQ(cv::norm(frame.colour, picture(i), cv::NORM_INF), 0) << i;
      }
      kept.push_back(frame.grey);
    }
    EXPECT_GT(cv::norm(kept[0], kept[4], cv::NORM_INF), 0) << "a frame stays what it was";
    EXPECT_FALSE(frames->next(frame));
  }
}

class FailingGrabber final : public vpFrameGrabber {
 public:
  void open(vpImage<unsigned char>& I) override { I.resize(4, 6); }
  void open(vpImage<vpRGBa>&) override { throw vpException(vpException::ioError, "no colour here"); }
  void acquire(vpImage<unsigned char>& I) override {
    if (broken) throw vpException(vpException::ioError, "the cable is out");
    I.resize(4, 6);
  }
  void acquire(vpImage<vpRGBa>&) override {}
  void close() override { closed = true; }
  bool broken = false, closed = false;
};

TEST(VispGrabber, AFrameThatDoesNotComeIsUnreadableThenTheDeviceIsGone) {
  FailingGrabber grabber;
  VispGrabberOptions options;
  double now = 7;
  options.time_s = [&] { return now; };
  bool end = false;
  options.at_end = [&] { return end; };
  {
    const auto frames = frames_of(grabber, options);
    Frame frame;
    ASSERT_TRUE(frames->next(frame));
    EXPECT_EQ(frame.time_s, 7);
    grabber.broken = true;
    ASSERT_TRUE(frames->next(frame));
    EXPECT_EQ(frame.status, FrameStatus::UNREADABLE);
    EXPECT_NE(frame.note.find("the cable is out"), std::string::npos);
    grabber.broken = false;
    ASSERT_TRUE(frames->next(frame));
    EXPECT_EQ(frame.status, FrameStatus::OK);
    EXPECT_EQ(frame.sequence, 2u);
    grabber.broken = true;
    const std::string why = message_of<DeviceError>([&] {
      while (frames->next(frame)) continue;
    });
    EXPECT_NE(why.find("the cable is out"), std::string::npos);
    end = true;
    EXPECT_FALSE(frames->next(frame));
  }
  EXPECT_TRUE(grabber.closed);
  options.colour = true;
  EXPECT_NE(message_of<DeviceError>([&] { frames_of(grabber, options); }).find("no colour here"), std::string::npos);
}

}  // namespace
}  // namespace heartservo::test
