#pragma once
// Runs a CaptureCore on a scripted device, by the device's clock.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "tests/tracking/frames/v4l2/fake_driver.hpp"
#include "tracking/frames/v4l2/capture_core.hpp"

namespace heartservo::test {

using namespace tracking;
using namespace tracking::v4l2;

class CaptureCoreTest : public testing::Test {
 protected:
  CaptureCoreTest() { options.device = "/dev/video0"; }

  /// Opens and runs until `end_s` on the driver's clock; keeps what was delivered.
  void run_until(double end_s) {
    if (!core) {
      core.emplace(driver, options, false);
      core->open();
    }
    Frame frame;
    int steps = 0;
    while (driver.now_s() < 1000 + end_s && !core->gave_up()) {
      const double before = driver.now_s();
      if (core->step(frame)) {
        if (!frames.empty()) {
          EXPECT_GT(frame.time_s, frames.back().time_s);
        }
        frames.push_back(frame);
        arrivals.push_back(driver.now_s() - 1000);
      }
      EXPECT_LE(driver.now_s() - before, 0.3) << "a step has an end";
      ASSERT_LT(++steps, 200000) << "the clock stands still";
    }
  }
  std::uint64_t count(Event event) const { return core->events().count(event); }
  std::string detail(Event event) const {
    for (const auto& record : core->events().records())
      if (record.event == event) return record.detail;
    return "never happened";
  }
  double when(Event event) const {
    for (const auto& record : core->events().records())
      if (record.event == event) return record.time_s;
    return NAN;
  }
  /// Seconds until the first good frame that arrived after `time_s`.
  double back_after(double time_s) const {
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (arrivals[i] > time_s && frames[i].status == FrameStatus::OK) return arrivals[i] - time_s;
    return INFINITY;
  }
  std::size_t events() const { return core->events().records().size(); }

  FakeDriver driver;
  CameraOptions options;
  std::optional<CaptureCore> core;
  std::vector<Frame> frames;
  std::vector<double> arrivals;
};

}  // namespace heartservo::test
