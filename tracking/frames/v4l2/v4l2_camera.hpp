#pragma once
// A V4L2 device as a source of frames. A thread of its own takes the frames from the driver, so that the newest one is
// always at hand and the driver never runs out of buffers.
#include <memory>
#include <string>

#include "tracking/frames/live_source.hpp"
#include "tracking/frames/v4l2/camera_options.hpp"
#include "tracking/frames/v4l2/system_calls.hpp"

namespace heartservo::tracking::v4l2 {

class V4l2Camera : public LiveSource {
 public:
  /// Waits for the next frame, `seconds` at most. Unlike next() it makes up no frame where none comes: false then, and
  /// at the end (see failure()).
  virtual bool wait_for(Frame& frame, double seconds) = 0;
  /// True once the frames have ended: the device did not come back.
  virtual bool ended() const = 0;
};

/// next() gives the newest frame not given before, or all in their order (CameraOptions::every_frame). Where none comes
/// in time, it gives an UNREADABLE frame that says why: a loop goes on by its safety rules. False once the device has
/// not come back for give_up_s.
///
/// Returns when the first live picture is there. Throws DeviceError (no such device, busy, no signal, nothing that can
/// be decoded), ConfigError (an input or control that it does not have).
std::unique_ptr<V4l2Camera> open_v4l2_camera(const CameraOptions& options, bool with_colour,
                                             SystemCalls& calls = libv4l2_calls());

}  // namespace heartservo::tracking::v4l2
