#pragma once
// Any vpFrameGrabber of ViSP as a FrameSource: a laboratory's own camera, vpDiskGrabber, vpVideoReader and the like.
#include <functional>
#include <memory>

#include "tracking/frames/frame_source.hpp"

class vpFrameGrabber;

namespace heartservo::tracking {

struct VispGrabberOptions {
  double frame_rate_hz = 25;    ///< nominal; ViSP's grabbers do not say
  bool colour = false;          ///< acquire colour, and grey from it
  std::size_t frame_count = 0;  ///< how many there are; 0: unknown
  /// True when there is no further frame, asked before each; empty: until frame_count, or for ever.
  std::function<bool()> at_end;
  /// When the frame just acquired was exposed, s. Empty: sequence / frame_rate_hz, as for files. For a camera give a
  /// clock, less what it takes from the exposure to here.
  std::function<double()> time_s;
};

/// Opens the grabber, which the caller owns and keeps alive. A frame that it cannot acquire (it throws vpException) is
/// UNREADABLE, and the sequence goes on, except after `frame_count` or ten in a row: then next() throws DeviceError.
/// Throws DeviceError when it cannot be opened.
std::unique_ptr<FrameSource> frames_of(vpFrameGrabber& grabber, VispGrabberOptions options);

}  // namespace heartservo::tracking
