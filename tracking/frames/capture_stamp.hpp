#pragma once
#include <cstdint>

namespace heartservo::tracking {

/// When and how a frame of a live camera came.
struct CaptureStamp {
  double device_s = 0;                ///< as the driver stamped it, on its own clock
  double dequeued_s = 0;              ///< when we took it from the driver, on the clock of Frame::time_s
  double decoded_s = 0;               ///< when its picture was ready, on the same
  bool start_of_exposure = false;     ///< what the driver stamped; else the end of the frame
  bool clock_is_monotonic = false;    ///< device_s is CLOCK_MONOTONIC
  std::uint32_t device_sequence = 0;  ///< the driver's count
  std::uint32_t flags = 0;            ///< the driver's, V4L2_BUF_FLAG_...
  std::uint32_t missing = 0;          ///< frames that the driver dropped since the one before
  std::uint32_t skipped = 0;          ///< frames that we left out since the one before, because a newer one was there
};

}  // namespace heartservo::tracking
