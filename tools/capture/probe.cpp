#include "tools/capture/probe.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstring>

#include "tools/capture/capture_summary.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/frames/v4l2/controls.hpp"
#include "tracking/frames/v4l2/formats.hpp"
#include "tracking/frames/v4l2/offers.hpp"
#include "tracking/frames/v4l2/v4l2_camera.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;
using namespace tracking::v4l2;

struct Device {
  DeviceOffer offer;
  std::vector<Control> controls;
};

Device looked_at(const std::string& device) {
  SystemCalls& calls = libv4l2_calls();
  const int fd = calls.open(device);
  if (fd < 0)
    throw DeviceError(fmt::format("{}: cannot be opened: {}; 'heartservo capture --list' shows what there is", device,
                                  std::strerror(-fd)));
  struct Closing {
    SystemCalls& calls;
    int fd;
    ~Closing() { calls.close(fd); }
  } closing{calls, fd};
  return {offer_of(calls, fd, device), controls_of(calls, fd)};
}

json measured(CameraOptions options, const std::string& format, double seconds) {
  options.format = format;
  options.every_frame = true;
  json j{{"format", format}};
  try {
    const auto camera = open_v4l2_camera(options, false);
    tracking::Frame frame;
    const double end = camera->now_s() + seconds;
    while (camera->now_s() < end && !camera->ended()) camera->wait_for(frame, 0.1);
    j.update(json_of(camera->report()));
  } catch (const DeviceError& e) {
    j["problem"] = e.what();
  }
  return j;
}

}  // namespace

json probe(const CameraOptions& options, double seconds) {
  const Device device = looked_at(options.device);
  json j{{"command", "capture"},
         {"device", options.device},
         {"card", device.offer.card},
         {"formats", json::array()},
         {"controls", json::array()}};
  for (const auto& name : format_names()) {
    if (!options.format.empty() && options.format != name) continue;
    for (const auto& format : device.offer.formats)
      if (!format.emulated && (format.name == name || (name == "MJPG" && format.name == "JPEG"))) {
        j["formats"].push_back(measured(options, name, seconds));
        break;
      }
  }
  if (j["formats"].empty()) j["formats"].push_back(measured(options, options.format, seconds));
  const Device after = looked_at(options.device);  // now that the input is chosen: controls may be its own
  for (const auto& c : after.controls)
    j["controls"].push_back({{"name", c.name},
                             {"low", c.low},
                             {"high", c.high},
                             {"step", c.step},
                             {"standard", c.standard},
                             {"value", c.value},
                             {"menu", c.menu}});
  return j;
}

std::string probe_text(const json& j) {
  std::string text = fmt::format("{}: {}\n\n{:<8}{:<28}{:>8}{:>10}{:>9}{:>6}{:>8}{:>8}\n",
                                 j["device"].get<std::string>(), j["card"].get<std::string>(), "format", "granted",
                                 "Hz", "jitter ms", "missing", "bad", "age ms", "decode");
  for (const json& f : j["formats"]) {
    if (f.contains("problem")) {
      text += fmt::format("{:<8}{}\n", f["format"].get<std::string>(), f["problem"].get<std::string>());
      continue;
    }
    const json& m = f["measured"];
    text += fmt::format("{:<8}{:<28}{:>8.2f}{:>10.2f}{:>9}{:>6}{:>8.1f}{:>8.2f}\n", f["format"].get<std::string>(),
                        f["granted"]["format"].get<std::string>().substr(5), m["rate_hz"].get<double>(),
                        m["jitter_ms"].get<double>(), f["frames"]["missing"].get<int>(), f["frames"]["bad"].get<int>(),
                        m["transfer_ms"].get<double>() + m["decode_ms"].get<double>(), m["decode_ms"].get<double>());
    if (!f["events"].empty()) text += fmt::format("        {}\n", f["event_counts"].dump());
  }
  text += "\ncontrols:\n";
  for (const json& c : j["controls"])
    text += fmt::format("  {:<32}{} to {}, now {}\n", c["name"].get<std::string>(), c["low"].get<int>(),
                        c["high"].get<int>(), c["value"].get<int>());
  return text;
}

}  // namespace heartservo::tools
