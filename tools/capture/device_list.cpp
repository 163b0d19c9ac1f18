#include "tools/capture/device_list.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstring>

#include "tracking/frames/v4l2/offers.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;
using namespace tracking::v4l2;

json json_of(cv::Size size) { return {size.width, size.height}; }

json json_of(const DeviceOffer& offer) {
  json j{{"device", offer.device}, {"card", offer.card},      {"driver", offer.driver},
         {"bus", offer.bus},       {"inputs", json::array()}, {"formats", json::array()}};
  for (const auto& input : offer.inputs)
    j["inputs"].push_back({{"index", input.index},
                           {"name", input.name},
                           {"chosen", input.index == offer.input},
                           {"state", input.state.empty() ? json() : json(input.state)}});
  for (const auto& format : offer.formats) {
    json sizes = json::array();
    for (const auto& size : format.sizes)
      sizes.push_back({{"low", json_of(size.low)},
                       {"high", json_of(size.high)},
                       {"rates_hz", size.rates},
                       {"rates_are_range", size.rates_are_range}});
    j["formats"].push_back({{"name", format.name},
                            {"description", format.description},
                            {"decoded_by", format.decoded ? "heartservo" : "libv4l2"},
                            {"sizes", sizes}});
  }
  return j;
}

// Without the device's name and the advice to look at this list.
std::string in_list(const std::string& device, std::string problem) {
  if (problem.starts_with(device + ": ")) problem.erase(0, device.size() + 2);
  return problem.substr(0, problem.find("; "));
}

}  // namespace

json device_list() {
  json devices = json::array();
  SystemCalls& calls = libv4l2_calls();
  for (const std::string& device : video_devices()) {
    const int fd = calls.open(device);
    if (fd < 0) {
      devices.push_back({{"device", device}, {"problem", std::strerror(-fd)}});
      continue;
    }
    try {
      devices.push_back(json_of(offer_of(calls, fd, device)));
    } catch (const DeviceError& e) {  // an output, a codec, a camera's metadata
      devices.push_back({{"device", device}, {"problem", in_list(device, e.what())}});
    }
    calls.close(fd);
  }
  return devices;
}

std::string size_text(const json& size) {
  const auto pixels = [](const json& s) { return fmt::format("{}x{}", s[0].get<int>(), s[1].get<int>()); };
  std::string text = pixels(size["low"]);
  if (size["low"] != size["high"]) text += " to " + pixels(size["high"]);
  std::vector<std::string> rates;
  for (const auto& rate : size["rates_hz"]) rates.push_back(fmt::format("{:.4g}", rate.get<double>()));
  if (rates.empty()) return text;
  return text + fmt::format(" at {} Hz", fmt::join(rates, size["rates_are_range"].get<bool>() ? " to " : ", "));
}

std::string device_text(const json& devices) {
  if (devices.empty())
    return "no video device: there is no /dev/video*; plug the adapter in, or load its driver (see dmesg)\n";
  std::string text;
  for (const json& d : devices) {
    const std::string device = d["device"];
    if (d.contains("problem")) {
      text += fmt::format("{}: {}\n", device, d["problem"].get<std::string>());
      continue;
    }
    text += fmt::format("{}: {} ({}, {})\n", device, d["card"].get<std::string>(), d["driver"].get<std::string>(),
                        d["bus"].get<std::string>());
    for (const json& input : d["inputs"])
      text += fmt::format("  input {}  {}{}{}\n", input["index"].get<int>(), input["name"].get<std::string>(),
                          input["chosen"].get<bool>() ? ", chosen" : "",
                          input["state"].is_null() ? "" : ", " + input["state"].get<std::string>());
    for (const json& format : d["formats"]) {
      text += fmt::format("  {}  {}{}\n", format["name"].get<std::string>(), format["description"].get<std::string>(),
                          format["decoded_by"] == "libv4l2" ? " (through libv4l2)" : "");
      for (const json& size : format["sizes"]) text += fmt::format("        {}\n", size_text(size));
    }
  }
  return text;
}

}  // namespace heartservo::tools
