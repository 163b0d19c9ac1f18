#include "tracking/frames/v4l2/stamp_clock.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>

namespace heartservo::tracking::v4l2 {

namespace {

constexpr double OLDEST_s = 2;    // a frame that took longer from the sensor to us has a wrong stamp
constexpr double FUTURE_s = 0.1;  // drivers under emulation stamp up to 35 ms ahead
constexpr double LATER_s = 1e-6;  // frames are told apart by it where a stamp repeats

}  // namespace

const char* name_of(StampOrigin origin) {
  return origin == StampOrigin::MONOTONIC ? "monotonic" : origin == StampOrigin::FOREIGN ? "foreign" : "arrival";
}

StampClock::Stamp StampClock::stamp(double device_s, double arrival_s, std::uint32_t flags) {
  const bool usable = std::isfinite(device_s) && device_s != 0 &&
                      (flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_COPY;
  const auto plausible = [&](double time) { return arrival_s - time < OLDEST_s && time - arrival_s < FUTURE_s; };
  Stamp stamp;
  if (!usable) {
    stamp.origin = origin_ = StampOrigin::ARRIVAL;
    stamp.time_s = arrival_s;
  } else if (!started_ || origin_ == StampOrigin::ARRIVAL) {
    const bool ours = plausible(device_s);
    shift_s_ = ours ? 0 : arrival_s - device_s;
    origin_ = ours ? StampOrigin::MONOTONIC : StampOrigin::FOREIGN;
  } else if (!plausible(device_s + shift_s_) || device_s < last_device_s_) {
    stamp.jumped = true;
    stamp.jump = fmt::format("the driver's time went from {:.6f} s to {:.6f} s", last_device_s_, device_s);
    const bool ours = plausible(device_s) && device_s + LATER_s > last_s_;
    shift_s_ = ours ? 0 : arrival_s - usual_age_s_ - device_s;
    origin_ = ours ? StampOrigin::MONOTONIC : StampOrigin::FOREIGN;
  }
  if (usable) {
    stamp.time_s = device_s + shift_s_;
    stamp.origin = origin_;
    const double age = std::max(0.0, arrival_s - stamp.time_s);
    usual_age_s_ = started_ ? usual_age_s_ + 0.1 * (age - usual_age_s_) : age;
    last_device_s_ = device_s;
    started_ = true;
  }
  stamp.time_s = std::max(stamp.time_s, last_s_ + LATER_s);
  last_s_ = stamp.time_s;
  return stamp;
}

}  // namespace heartservo::tracking::v4l2
