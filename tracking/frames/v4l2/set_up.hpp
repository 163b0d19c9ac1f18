#pragma once
// Sets a device up as the options say, and tells what it granted.
#include <cstdint>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tracking/frames/v4l2/camera_options.hpp"
#include "tracking/frames/v4l2/signal.hpp"
#include "tracking/frames/v4l2/system_calls.hpp"

namespace heartservo::tracking::v4l2 {

struct Granted {
  std::string device, driver, card, bus, input;
  std::uint32_t fourcc = 0;
  cv::Size size;            ///< of the whole picture, both fields
  std::uint32_t field = 0;  ///< V4L2_FIELD_...
  std::uint32_t bytes_per_line = 0, bytes = 0;
  std::uint32_t quantisation = 0;     ///< V4L2_QUANTIZATION_...
  double rate_hz = 0;                 ///< pictures a second (fields, for alternating ones); 0: it does not say
  std::optional<Timings> timings;     ///< of a digital input
  std::vector<std::string> controls;  ///< as set_controls() says
  double exposure_s = 0;              ///< 0: unknown

  std::string format() const;  ///< "YUYV 640x480 at 30.00 Hz, progressive"
};

/// True where each buffer holds one field, half the picture's height.
bool is_single_field(std::uint32_t field);

/// Input, timings of the signal, format, size, rate, controls. Throws DeviceError (no such thing, or nothing that can
/// be decoded; naming what there is), ConfigError for an input or control that the device does not have.
Granted set_up(SystemCalls& calls, int fd, const CameraOptions& options);

}  // namespace heartservo::tracking::v4l2
