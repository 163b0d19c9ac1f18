// The faults that stop the frames (docs/capture.md), on a scripted device: noticed, named, recovered from.
#include "tests/tracking/frames/v4l2/capture_core_fixture.hpp"

namespace heartservo::test {
namespace {

using CaptureRecoveryTest = CaptureCoreTest;

TEST_F(CaptureRecoveryTest, AllBuffersBrokenRestartsTheStream) {  // UVC bulk transfer error
  driver.at(0.5, [](auto& d) { d.bad_buffers = 4; });
  run_until(1.5);
  EXPECT_EQ(count(Event::BAD_BUFFER), 4u);
  EXPECT_EQ(count(Event::RESTARTED), 1u);
  EXPECT_EQ(count(Event::RECOVERED), 1u);
  EXPECT_EQ(driver.starts, 2);
  EXPECT_LT(back_after(0.5), 0.2);
}

TEST_F(CaptureRecoveryTest, FatalErrorRestartsTheStream) {
  driver.at(0.5, [](auto& d) { d.dead = true; });
  run_until(1.5);
  EXPECT_EQ(count(Event::STREAM_ERROR), 1u);
  EXPECT_EQ(count(Event::RESTARTED), 1u);
  EXPECT_EQ(count(Event::RECOVERED), 1u);
  EXPECT_LT(back_after(0.5), 0.2);
  EXPECT_EQ(driver.opens, 1);
}

TEST_F(CaptureRecoveryTest, ADisconnectedDeviceWhoseNodeStays) {
  driver.at(0.5, [](auto& d) { d.plugged = false; });
  driver.at(0.7, [](auto& d) { d.plugged = true; });
  run_until(2);
  EXPECT_EQ(count(Event::DISCONNECTED), 1u);
  EXPECT_EQ(count(Event::UNPLUGGED), 0u);
  EXPECT_EQ(count(Event::REOPENED), 1u);
  EXPECT_EQ(count(Event::RECOVERED), 1u);
  EXPECT_LT(back_after(0.7), 0.3);
  EXPECT_EQ(driver.opens, 2);
  EXPECT_EQ(core->fault(), "");
}

TEST_F(CaptureRecoveryTest, AnUnpluggedDeviceComesBackWithFullSetUp) {
  options.controls = {{"gain_analogue", "20"}};
  driver.at(0.5, [](auto& d) { d.plugged = d.node = false; });
  driver.at(3.0, [](auto& d) { d.plugged = d.node = true, d.gain = 0; });
  run_until(2);
  EXPECT_EQ(count(Event::UNPLUGGED), 1u);
  EXPECT_EQ(core->fault(), "the device is unplugged");
  run_until(5);
  EXPECT_EQ(count(Event::REOPENED), 1u);
  EXPECT_LT(back_after(3.0), 2);
  EXPECT_EQ(driver.gain, 20);
  EXPECT_EQ(driver.mapped, 4);
  EXPECT_NEAR(frames.back().time_s, 5, 0.1) << "time goes on over the outage";
}

TEST_F(CaptureRecoveryTest, ADeviceThatDoesNotComeBackEndsIt) {
  options.give_up_s = 3;
  driver.at(0.5, [](auto& d) { d.plugged = d.node = false; });
  run_until(100);
  EXPECT_TRUE(core->gave_up());
  EXPECT_LT(driver.now_s() - 1000, 4);
  EXPECT_EQ(count(Event::GAVE_UP), 1u);
  EXPECT_NE(core->fault().find("did not come back within 3 s"), std::string::npos);
}

TEST_F(CaptureRecoveryTest, ASignalThatStopsFramesIsNamedAndComesBack) {
  driver.dv = driver.broken_signal_stops = true;
  driver.at(1, [](auto& d) { d.signal_error = ENOLINK; });
  driver.at(4, [](auto& d) { d.signal_error = 0; });
  run_until(6);
  EXPECT_EQ(count(Event::NO_SIGNAL), 1u);
  EXPECT_GE(count(Event::STARVED), 1u);
  EXPECT_LT(back_after(4), 2);
}

TEST_F(CaptureRecoveryTest, AChangedResolutionIsSetUpAnew) {
  driver.dv = true;
  driver.at(1, [](auto& d) { d.signal_width = 80, d.signal_height = 60; });
  driver.at(3, [](auto& d) { d.signal_width = 64, d.signal_height = 48; });
  run_until(5);
  EXPECT_EQ(count(Event::RESOLUTION_CHANGED), 2u);
  EXPECT_EQ(count(Event::REOPENED), 2u);
  EXPECT_EQ(driver.timings_set, 3);
  bool other = false;
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (arrivals[i] > 2 && arrivals[i] < 3) {
      other = true;
      EXPECT_EQ(frames[i].status, FrameStatus::UNREADABLE);
      EXPECT_NE(frames[i].note.find("80 x 60 px, the first one was 64 x 48"), std::string::npos);
    }
  EXPECT_TRUE(other);
  EXPECT_LT(back_after(3), 2);
  EXPECT_EQ(frames.back().status, FrameStatus::OK);
}

TEST_F(CaptureRecoveryTest, AStreamThatStallsIsStartedAnewThenOpenedAnew) {  // UVC freeze: nothing but poll time-outs
  driver.at(1, [](auto& d) { d.stalled = true; });
  driver.at(6, [](auto& d) { d.stalled = false; });
  run_until(9);
  EXPECT_GE(count(Event::STARVED), 1u);
  EXPECT_NEAR(when(Event::STARVED), 1.5, 0.15);
  EXPECT_NE(detail(Event::STARVED).find("poll says that there is none"), std::string::npos);
  EXPECT_GE(count(Event::RESTARTED), 2u);
  EXPECT_GE(count(Event::REOPENED), 1u);
  EXPECT_LT(back_after(6), 2);
}

TEST_F(CaptureRecoveryTest, StarvationWhilePollSaysThereAreFrames) {  // libv4l2 with 4:2:2 JPEG
  driver.at(1, [](auto& d) { d.lying_poll = true; });
  driver.at(3, [](auto& d) { d.lying_poll = false; });
  run_until(5);
  EXPECT_NEAR(when(Event::STARVED), 1.5, 0.15);
  EXPECT_NE(detail(Event::STARVED).find("poll says that there is one"), std::string::npos);
  EXPECT_LT(back_after(3), 2);
  EXPECT_LT(driver.polls, 8000) << "it does not spin";
}

TEST_F(CaptureRecoveryTest, ADeviceThatNeverDeliversAgainEndsIt) {
  options.give_up_s = 5;
  driver.at(1, [](auto& d) { d.stalled = true; });
  run_until(100);
  EXPECT_TRUE(core->gave_up());
  EXPECT_LT(driver.now_s() - 1000, 9);
}

TEST_F(CaptureRecoveryTest, AManyFaultsStormEnds) {
  options.controls = {{"gain_analogue", "20"}};
  for (int i = 0; i < 20; ++i) {
    driver.at(0.5 + i, [](auto& d) { d.dead = true; });
    driver.at(0.6 + i, [](auto& d) { d.bad_buffers = 5; });
    driver.at(0.7 + i, [](auto& d) { d.plugged = d.node = false; });
    driver.at(0.9 + i, [](auto& d) { d.plugged = d.node = true, d.stamp_offset_s += 100; });
    driver.at(1.2 + i, [](auto& d) { d.drop = 4; });
  }
  run_until(24);
  EXPECT_EQ(frames.back().status, FrameStatus::OK);
  EXPECT_EQ(core->fault(), "");
  EXPECT_GT(frames.size(), 500u);
  EXPECT_EQ(driver.mapped, 4) << "buffers of every stream before were given up";
}

}  // namespace
}  // namespace heartservo::test
