#pragma once
// A camera: its frames come whether they are asked for or not, and may stop.
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tracking/frames/frame_source.hpp"

namespace heartservo::tracking {

struct CaptureEvent {
  double time_s = 0;  ///< on the clock of Frame::time_s
  std::string name, detail;
};

/// What a camera was asked for, what it granted and what was measured.
struct CaptureReport {
  std::string device, card, driver, input;
  std::string wanted, granted, timings, crop;
  std::vector<std::string> controls;
  std::string stamps;                          ///< clock, and start of exposure or end of frame
  double granted_rate_hz = 0;                  ///< 0: it does not say
  double measured_rate_hz = 0, jitter_ms = 0;  ///< median rate; standard deviation of the interval between frames
  double transfer_ms = 0, decode_ms = 0;       ///< medians: from the time stamp to us; from bytes to picture
  std::uint64_t frames = 0, skipped = 0, missing = 0, bad = 0, queue_dropped = 0;
  std::map<std::string, std::uint64_t> event_counts;
  std::vector<CaptureEvent> events;  ///< the last ones
};

class LiveSource : public FrameSource {
 public:
  /// Now, on the clock of the frames' time_s.
  virtual double now_s() const = 0;
  /// Why next() returned false: the camera did not come back. "" while all is well.
  virtual std::string failure() const = 0;
  virtual CaptureReport report() const = 0;
  LiveSource* live() override { return this; }
};

}  // namespace heartservo::tracking
