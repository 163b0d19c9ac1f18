#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tracking/frames/v4l2/system_calls.hpp"

namespace heartservo::tracking::v4l2 {

struct Control {
  std::uint32_t id = 0;
  std::string name;  ///< as `v4l2-ctl` writes it: lower case, '_' for what is no letter: exposure_time_absolute
  std::int32_t low = 0, high = 0, step = 1, standard = 0, value = 0;
  std::vector<std::string> menu;  ///< names of a menu's values from `low` on; "" for one that cannot be chosen
};

/// The device's controls with their values; those that are disabled or no numbers are left out.
std::vector<Control> controls_of(SystemCalls& calls, int fd);

/// Sets them in the order given and reads them back. Returns name, wanted and granted value ("wanted -> granted" where
/// they differ), a line each. Throws ConfigError for a name or value that the device does not have.
std::vector<std::string> set_controls(SystemCalls& calls, int fd, const std::string& device,
                                      const std::vector<std::pair<std::string, std::string>>& wanted);

/// Exposure time in s, where the device says; else 0.
double exposure_s(SystemCalls& calls, int fd);

}  // namespace heartservo::tracking::v4l2
