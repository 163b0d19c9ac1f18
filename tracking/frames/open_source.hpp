#pragma once
#include <memory>
#include <string>

#include "tracking/frames/frame_source.hpp"

namespace heartservo::tracking {

/// Opens what is on disk: a recording of `heartservo capture`, with its own time stamps; a folder of pictures, a printf
/// pattern (dir/img%04d.png), one picture (a folder of one), or a video file; or the camera of "v4l2:/dev/video0"
/// (v4l2/camera_options.hpp). `frame_rate_hz` <= 0: a video's or camera's own rate, 25 Hz for pictures. Throws InputError
/// naming the path; DeviceError, ConfigError for a camera.
std::unique_ptr<FrameSource> open_source(const std::string& source, double frame_rate_hz);

}  // namespace heartservo::tracking
