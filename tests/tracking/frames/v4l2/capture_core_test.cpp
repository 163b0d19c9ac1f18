// What comes, and the faults that do not stop it (docs/capture.md), on a scripted device: noticed and named.
#include "tests/tracking/frames/v4l2/capture_core_fixture.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::test {
namespace {

TEST_F(CaptureCoreTest, DeliversEveryFrameOfAHealthyCamera) {
  run_until(2);
  EXPECT_NEAR(static_cast<double>(frames.size()), 100, 2);
  EXPECT_EQ(events(), 0u);
  EXPECT_EQ(frames[0].time_s, 0);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].status, FrameStatus::OK);
    EXPECT_EQ(frames[i].sequence, i);
    EXPECT_NEAR(frames[i].time_s, 0.02 * static_cast<double>(i), 1e-4);
    EXPECT_TRUE(frames[i].capture->clock_is_monotonic);
    EXPECT_GE(frames[i].capture->dequeued_s, frames[i].time_s);
    EXPECT_GE(frames[i].capture->decoded_s, frames[i].capture->dequeued_s);
  }
  const auto report = core->report();
  EXPECT_NEAR(report.measured_rate_hz, 50, 0.1);
  EXPECT_LT(report.jitter_ms, 0.1);
  EXPECT_EQ(report.granted, "GREY 64x48 at 50.00 Hz, progressive");
}

TEST_F(CaptureCoreTest, TheNewestFrameIsGivenAndSkippedOnesAreCounted) {
  run_until(0.5);
  driver.sleep(0.061);  // three frames come meanwhile
  Frame frame;
  ASSERT_TRUE(core->step(frame));
  EXPECT_EQ(frame.capture->skipped, 2u);
  EXPECT_EQ(frame.sequence, frames.back().sequence + 3);
  EXPECT_LT(core->now_s() - frame.time_s, 0.021);
  EXPECT_EQ(core->report().skipped, 2u);
}

TEST_F(CaptureCoreTest, EveryFrameWhereAsked) {
  options.every_frame = true;
  run_until(0.5);
  driver.sleep(0.061);
  const std::uint64_t last = frames.back().sequence;
  for (std::uint64_t i = 1; i <= 3; ++i) {
    Frame frame;
    ASSERT_TRUE(core->step(frame));
    EXPECT_EQ(frame.sequence, last + i);
  }
  EXPECT_EQ(core->report().skipped, 0u);
}

TEST_F(CaptureCoreTest, BadBuffer) {
  driver.at(0.5, [](auto& d) { d.bad_buffers = 1; });
  run_until(1);
  EXPECT_EQ(count(Event::BAD_BUFFER), 1u);
  EXPECT_EQ(count(Event::RESTARTED), 0u);
  EXPECT_NE(detail(Event::BAD_BUFFER).find("marked as broken"), std::string::npos);
  EXPECT_LT(back_after(0.5), 0.06);
}

TEST_F(CaptureCoreTest, EmptyBuffer) {
  driver.at(0.5, [](auto& d) { d.empty_buffers = 2; });
  run_until(1);
  EXPECT_EQ(count(Event::BAD_BUFFER), 2u);
  EXPECT_NE(detail(Event::BAD_BUFFER).find("empty"), std::string::npos);
}

TEST_F(CaptureCoreTest, ShortBufferIsNoPicture) {
  driver.at(0.5, [](auto& d) { d.short_buffers = 1; });
  run_until(1);
  EXPECT_EQ(count(Event::BAD_PICTURE), 1u);
  EXPECT_NE(detail(Event::BAD_PICTURE).find("1536 of 3072 bytes"), std::string::npos);
}

TEST_F(CaptureCoreTest, DroppedBuffersAreAGapInTheSequence) {
  driver.at(0.5, [](auto& d) { d.drop = 3; });
  run_until(1);
  EXPECT_EQ(count(Event::SEQUENCE_GAP), 1u);
  EXPECT_EQ(detail(Event::SEQUENCE_GAP).substr(0, 8), "3 frames");
  EXPECT_EQ(core->report().missing, 3u);
  EXPECT_NEAR(frames.back().time_s, 0.02 * static_cast<double>(frames.back().sequence), 1e-3) << "missing ones count";
}

TEST_F(CaptureCoreTest, ASequenceThatWrapsIsNoFault) {
  driver.first_sequence = 0xffffffffu - 10;
  run_until(1);
  EXPECT_EQ(events(), 0u);
  EXPECT_EQ(frames.back().sequence, frames.size() - 1);
}

TEST_F(CaptureCoreTest, NoSignalNoLockOutOfRangeWhileFramesKeepFlowing) {
  driver.dv = true;
  const std::pair<int, Event> faults[] = {
      {ENOLINK, Event::NO_SIGNAL}, {ENOLCK, Event::NO_LOCK}, {ERANGE, Event::OUT_OF_RANGE}};
  double time = 1;
  for (const auto& [error, event] : faults) {
    driver.at(time, [e = error](auto& d) { d.signal_error = e; });
    driver.at(time + 1, [](auto& d) { d.signal_error = 0; });
    time += 2;
  }
  run_until(time);
  for (const auto& [error, event] : faults) EXPECT_EQ(count(event), 1u) << name_of(event);
  EXPECT_EQ(count(Event::SIGNAL_BACK), 3u);
  EXPECT_LT(when(Event::NO_SIGNAL), 1.3);
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (arrivals[i] > 1.3 && arrivals[i] < 2) {
      EXPECT_EQ(frames[i].status, FrameStatus::NOT_LIVE);
      EXPECT_EQ(frames[i].note, "/dev/video0: no_signal");
      EXPECT_FALSE(frames[i].grey.empty()) << "for the record";
    }
  EXPECT_EQ(frames.back().status, FrameStatus::OK);
  EXPECT_EQ(driver.starts, 1);
}

TEST_F(CaptureCoreTest, AnInputWithoutSignalByItsStatus) {
  driver.at(0.5, [](auto& d) { d.input_status = V4L2_IN_ST_NO_SIGNAL; });
  driver.at(1.0, [](auto& d) { d.input_status = 0; });
  run_until(2);
  EXPECT_EQ(count(Event::NO_SIGNAL), 1u);
  EXPECT_EQ(count(Event::SIGNAL_BACK), 1u);
}

TEST_F(CaptureCoreTest, ASourceChangeEventIsActedOnAtOnce) {
  driver.dv = driver.source_change_events = true;
  options.signal_check_s = 3600;
  driver.at(1, [](auto& d) { d.signal_error = ENOLINK, d.event_pending_ = true; });
  run_until(2);
  EXPECT_EQ(count(Event::NO_SIGNAL), 1u);
  EXPECT_LT(when(Event::NO_SIGNAL), 1.05);
}

TEST_F(CaptureCoreTest, AFrozenPictureAtFullRate) {
  driver.at(1, [](auto& d) { d.frozen_picture = true; });
  driver.at(3, [](auto& d) { d.frozen_picture = false; });
  run_until(4);
  EXPECT_EQ(count(Event::FROZEN_PICTURE), 1u);
  EXPECT_EQ(count(Event::PICTURE_MOVES), 1u);
  EXPECT_NEAR(when(Event::FROZEN_PICTURE), 2, 0.1);
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (arrivals[i] > 2.1 && arrivals[i] < 3) {
      EXPECT_EQ(frames[i].status, FrameStatus::NOT_LIVE);
    }
  EXPECT_EQ(frames.back().status, FrameStatus::OK);
}

TEST_F(CaptureCoreTest, AFrozenPictureIsFineWhereItIsExpected) {
  options.frozen_s = 0;
  driver.frozen_picture = true;
  run_until(4);
  EXPECT_EQ(events(), 0u);
  EXPECT_EQ(frames.back().status, FrameStatus::OK);
}

TEST_F(CaptureCoreTest, ATimeJumpGoesOnByOurClock) {
  driver.at(1, [](auto& d) { d.stamp_offset_s = 5000; });
  driver.at(2, [](auto& d) { d.stamp_offset_s = -900; });  // a wrap
  run_until(3);
  EXPECT_EQ(count(Event::TIME_JUMP), 2u);
  EXPECT_NE(detail(Event::TIME_JUMP).find("went from 10"), std::string::npos);
  for (std::size_t i = 0; i < frames.size(); ++i)
    EXPECT_NEAR(frames[i].time_s, 0.02 * static_cast<double>(i), 0.002) << i;
  EXPECT_FALSE(frames.back().capture->clock_is_monotonic);
}

TEST_F(CaptureCoreTest, StampsInTheFutureAreTakenAsTheyAre) {
  driver.stamp_offset_s = 0.035;
  run_until(1);
  EXPECT_EQ(events(), 0u);
  EXPECT_TRUE(frames.back().capture->clock_is_monotonic);
}

TEST_F(CaptureCoreTest, AForeignClockCountsDifferences) {
  driver.stamp_offset_s = 1e6;
  run_until(1);
  EXPECT_EQ(events(), 0u);
  EXPECT_FALSE(frames.back().capture->clock_is_monotonic);
  EXPECT_NEAR(frames.back().time_s, 0.02 * static_cast<double>(frames.size() - 1), 1e-3);
}

TEST_F(CaptureCoreTest, TheMiddleOfTheExposure) {
  driver.exposure_100us = 100;  // 10 ms
  driver.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  run_until(0.5);
  EXPECT_TRUE(frames.back().capture->start_of_exposure);
  const double origin_s = driver.now_s() - core->now_s();
  EXPECT_NEAR(frames[3].time_s + origin_s, frames[3].capture->device_s + 0.005, 1e-5);
  EXPECT_NEAR(frames[3].time_s - frames[0].time_s, 0.06, 1e-6);
}

TEST_F(CaptureCoreTest, WhatItRefuses) {
  const auto expect_error = [&](const std::string& part) {
    CaptureCore refused(driver, options, false);
    try {
      refused.open();
      ADD_FAILURE() << "opened; expected: " << part;
    } catch (const std::exception& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  driver.open_error = ENOENT;
  expect_error("No such file or directory; 'heartservo capture --list'");
  driver.open_error = EACCES;
  expect_error("group 'video'");
  driver.open_error = 0;
  driver.stream_on_error = EBUSY;
  expect_error("another program uses the device");
  driver.stream_on_error = 0;
  options.input = "SDI";
  expect_error("has no input 'SDI'; it has 0 (Webcam 0), 1 (S-Video 0)");
  options.input = "s-video";
  options.controls = {{"gain_analog", "3"}};
  expect_error("'gain_analog' (did you mean 'gain_analogue'?)");
  options.controls = {{"gain_analogue", "3000"}};
  expect_error("whole number from 0 to 1000");
  options.controls.clear();
  driver.field = V4L2_FIELD_INTERLACED;
  options.fields = "refuse";
  expect_error("interlaced");
}

TEST_F(CaptureCoreTest, ControlsAreReadBack) {
  options.controls = {{"gain_analogue", "500"}};
  run_until(0.1);
  EXPECT_EQ(core->report().controls, std::vector<std::string>{"gain_analogue=500 -> 100"});
}

TEST_F(CaptureCoreTest, AlternatingFieldsMakeWholePictures) {
  driver.field = V4L2_FIELD_ALTERNATE;
  run_until(0.5);
  EXPECT_EQ(frames.back().grey.size(), cv::Size(64, 48));
  EXPECT_EQ(events(), 0u);
}

TEST_F(CaptureCoreTest, ADeviceThatScalesDoesNotStretchSingleFields) {
  driver.dv = true;
  driver.field = V4L2_FIELD_ALTERNATE;
  driver.scales_fields = true;
  run_until(0.5);
  EXPECT_EQ(frames.back().grey.size(), cv::Size(driver.signal_width, driver.signal_height));
  EXPECT_EQ(events(), 0u);
}

}  // namespace
}  // namespace heartservo::test
