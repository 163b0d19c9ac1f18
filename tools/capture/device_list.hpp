#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace heartservo::tools {

/// The video devices of this machine with inputs, formats, sizes and rates; those that cannot be opened with the
/// reason.
nlohmann::json device_list();

/// The same for people: "no video device" where there is none.
std::string device_text(const nlohmann::json& devices);

/// "640x480 at 30, 15 Hz", "2x1 to 1920x1080".
std::string size_text(const nlohmann::json& size);

}  // namespace heartservo::tools
