#pragma once
// What a device offers: inputs, formats, sizes and rates.
#include <cstdint>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "tracking/frames/v4l2/system_calls.hpp"

namespace heartservo::tracking::v4l2 {

struct SizeOffer {
  cv::Size low, high;            ///< the same for one size, else a range
  std::vector<double> rates;     ///< Hz; empty: it does not say
  bool rates_are_range = false;  ///< the first to the last of `rates`
};

struct FormatOffer {
  std::uint32_t fourcc = 0;
  std::string name, description;
  bool decoded = false;   ///< by us; the others by libv4l2, where it can
  bool emulated = false;  ///< made by libv4l2 from another format
  std::vector<SizeOffer> sizes;

  /// True if it can be `size` (empty: any) at `rate_hz` (0: any).
  bool offers(cv::Size size, double rate_hz) const;
};

struct InputOffer {
  std::uint32_t index = 0;
  std::string name;
  std::string state;  ///< "" or no_signal, no_lock
};

struct DeviceOffer {
  std::string device, driver, card, bus;
  std::vector<InputOffer> inputs;
  std::uint32_t input = 0;  ///< the chosen one
  std::vector<FormatOffer> formats;
};

/// Of an open device. `what` names it in the DeviceError that is thrown when it is no capture device.
DeviceOffer offer_of(SystemCalls& calls, int fd, const std::string& device);
std::vector<InputOffer> inputs_of(SystemCalls& calls, int fd);

/// Paths of the video devices of this machine, /dev/video0 before /dev/video10; capture or not.
std::vector<std::string> video_devices();

}  // namespace heartservo::tracking::v4l2
