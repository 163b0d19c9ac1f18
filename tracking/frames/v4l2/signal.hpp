#pragma once
// What an input receives: the signal's state, and the timings of a digital one (HDMI, SDI).
#include <linux/videodev2.h>

#include <opencv2/core/types.hpp>
#include <optional>
#include <string>

#include "tracking/frames/v4l2/events.hpp"
#include "tracking/frames/v4l2/system_calls.hpp"

namespace heartservo::tracking::v4l2 {

struct Timings {
  v4l2_dv_timings raw{};
  cv::Size size;
  bool interlaced = false;
  double rate_hz = 0;  ///< frames, not fields, a second

  std::string text() const;  ///< "1920x1080p 60.00 Hz"
  bool same_as(const Timings& other) const;
};

struct Signal {
  std::optional<Event> fault;      ///< NO_SIGNAL, NO_LOCK or OUT_OF_RANGE
  std::optional<Timings> timings;  ///< of a digital signal that is there
};

/// Asks the chosen input. An input that cannot say (a webcam) has no fault.
Signal signal_of(SystemCalls& calls, int fd);

/// The timings that the device is set to.
std::optional<Timings> timings_set(SystemCalls& calls, int fd);

/// 0 or -errno.
int set_timings(SystemCalls& calls, int fd, const Timings& timings);

}  // namespace heartservo::tracking::v4l2
