#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "tracking/frames/v4l2/camera_options.hpp"

namespace heartservo::tools {

/// Captures for `seconds` in every format that the device has and we decode (or in the one that the options name) and
/// measures: rate, jitter, frames missing, bad ones, age of a frame when it is ready. Beside it the device's controls.
/// Throws DeviceError, ConfigError.
nlohmann::json probe(const tracking::v4l2::CameraOptions& options, double seconds);

std::string probe_text(const nlohmann::json& probed);

}  // namespace heartservo::tools
