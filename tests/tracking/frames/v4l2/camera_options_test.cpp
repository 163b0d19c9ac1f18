#include "tracking/frames/v4l2/camera_options.hpp"

#include <gtest/gtest.h>

#include "tests/support/message.hpp"
#include "tracking/frames/v4l2/events.hpp"
#include "tracking/frames/v4l2/formats.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::test {
namespace {

using namespace tracking::v4l2;

TEST(CameraOptions, AreReadFromTheSource) {
  const auto o = parse_camera(
      "v4l2:/dev/video2,format=MJPG,size=1280x720,rate=29.97,input=HDMI,crop=round,frames=every,fields=refuse,"
      "no-frame-s=0.2,frozen-s=0,give-up-s=5,gain=10,exposure=manual_mode");
  EXPECT_EQ(o.device, "/dev/video2");
  EXPECT_EQ(o.format, "MJPG");
  EXPECT_EQ(o.size, cv::Size(1280, 720));
  EXPECT_EQ(o.rate_hz, 29.97);
  EXPECT_EQ(o.input, "HDMI");
  EXPECT_EQ(o.crop, "round");
  EXPECT_EQ(o.fields, "refuse");
  EXPECT_TRUE(o.every_frame);
  EXPECT_EQ(o.no_frame_s, 0.2);
  EXPECT_EQ(o.frozen_s, 0);
  EXPECT_EQ(o.give_up_s, 5);
  ASSERT_EQ(o.controls.size(), 2u);
  EXPECT_EQ(o.controls[1], (std::pair<std::string, std::string>{"exposure", "manual_mode"}));
  EXPECT_FALSE(parse_camera("/dev/video0").every_frame);
  EXPECT_EQ(parse_camera("/dev/video0,crop=10:20:300:200").crop, "10:20:300:200");
}

TEST(CameraOptions, WrongOnesAreRefused) {
  for (const char* wrong :
       {"v4l2:", "/dev/video0,size", "/dev/video0,=3", "/dev/video0,size=12", "/dev/video0,size=ax3",
        "/dev/video0,format=H264", "/dev/video0,rate=0", "/dev/video0,rate=nan", "/dev/video0,crop=1:2:3",
        "/dev/video0,crop=-1:2:300:300", "/dev/video0,fields=weave", "/dev/video0,frames=some",
        "/dev/video0,input=", "/dev/video0,size=1e9x3", "/dev/video0,"})
    EXPECT_NE(message_of<ConfigError>([&] { parse_camera(wrong); }), "nothing was thrown") << wrong;
  EXPECT_NE(message_of<ConfigError>([] { parse_camera("/dev/video0,size=12"); }).find("size=640x480"),
            std::string::npos);
}

TEST(CameraOptions, NamesOfFormatsAndEvents) {
  for (const auto& name : format_names()) {
    EXPECT_EQ(fourcc_name(fourcc_of(name)), name);
    EXPECT_TRUE(can_decode(fourcc_of(name)));
  }
  EXPECT_FALSE(can_decode(fourcc_of("H264")));
  EXPECT_STREQ(name_of(Event::GAVE_UP), "gave_up");
  EXPECT_STREQ(name_of(Event::STREAM_ERROR), "stream_error");
  EXPECT_STREQ(name_of(Event::RECOVERED), "recovered");
  EventLog log(3);
  for (int i = 0; i < 5; ++i) log.add(i, Event::BAD_BUFFER, "");
  EXPECT_EQ(log.records().size(), 3u);
  EXPECT_EQ(log.records()[0].time_s, 2);
  EXPECT_EQ(log.counts().at("bad_buffer"), 5u);
}

}  // namespace
}  // namespace heartservo::test
