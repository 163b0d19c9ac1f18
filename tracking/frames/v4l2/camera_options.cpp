#include "tracking/frames/v4l2/camera_options.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <functional>
#include <map>

#include "tracking/frames/v4l2/formats.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking::v4l2 {

namespace {

constexpr const char* PREFIX = "v4l2:";

struct Key {
  std::function<bool(CameraOptions&, const std::string&)> take;  // false: not such a value
  const char* form;
  const char* help;
};

bool number(const std::string& text, double low, double high, double& value) {
  double read = NAN;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), read);
  if (error != std::errc() || end != text.data() + text.size() || !(read >= low && read <= high)) return false;
  value = read;
  return true;
}

bool whole_size(const std::string& text, cv::Size& size) {
  const auto x = text.find('x');
  double w = 0, h = 0;
  if (x == text.npos || !number(text.substr(0, x), 16, 16384, w) || !number(text.substr(x + 1), 16, 16384, h))
    return false;
  size = {static_cast<int>(w), static_cast<int>(h)};
  return true;
}

bool one_of(const std::string& text, const std::vector<std::string>& names, std::string& value) {
  for (const auto& name : names)
    if (text == name) return value = text, true;
  return false;
}

bool crop_text(const std::string& text, std::string& value) {
  if (text == "round") return value = text, true;
  double part = 0;
  std::size_t count = 0, from = 0;
  for (; from <= text.size(); ++count) {
    const auto to = std::min(text.find(':', from), text.size());
    if (!number(text.substr(from, to - from), count < 2 ? 0 : 16, 16384, part)) return false;
    from = to + 1;
  }
  return count == 4 ? (value = text, true) : false;
}

const std::map<std::string, Key>& keys() {
  using O = CameraOptions;
  using T = const std::string&;
  static const std::map<std::string, Key> all{
      {"format",
       {[](O& o, T t) { return one_of(t, format_names(), o.format); }, "MJPG",
        "GREY, YUYV, UYVY, NV12, YU12, RGB3, BGR3 or MJPG; else the first of these that the device has"}},
      {"size", {[](O& o, T t) { return whole_size(t, o.size); }, "640x480", "picture size in px"}},
      {"rate", {[](O& o, T t) { return number(t, 0.1, 1000, o.rate_hz); }, "25", "frames per second"}},
      {"input", {[](O& o, T t) { return !(o.input = t).empty(); }, "HDMI", "number or part of the name of an input"}},
      {"fields",
       {[](O& o, T t) {
          return one_of(t, {"double", "refuse"}, o.fields);
        },
        "refuse", "interlaced pictures: double (default) shows one field with its lines doubled; refuse"}},
      {"crop",
       {[](O& o, T t) { return crop_text(t, o.crop); }, "round",
        "round: to the endoscope's round picture, found in the first one; or X:Y:WIDTH:HEIGHT in px"}},
      {"frames",
       {[](O& o, T t) {
          std::string which;
          const bool known = one_of(t, {"newest", "every"}, which);
          return o.every_frame = which == "every", known;
        },
        "every", "newest (default of track and servo) or every"}},
      {"no-frame-s",
       {[](O& o, T t) { return number(t, 0.05, 60, o.no_frame_s); }, "0.5",
        "without a good frame for so long the stream is started anew"}},
      {"frozen-s",
       {[](O& o, T t) { return number(t, 0, 3600, o.frozen_s); }, "1",
        "identical pictures for so long are frozen; 0: never"}},
      {"give-up-s",
       {[](O& o, T t) { return number(t, 0, 1e6, o.give_up_s); }, "30", "a device that is away longer ends the run"}},
  };
  return all;
}

void take(CameraOptions& options, const std::string& part, const std::string& source) {
  const auto equals = part.find('=');
  if (equals == part.npos || equals == 0)
    throw ConfigError(fmt::format("{}: '{}' must be KEY=VALUE, such as size=640x480", source, part));
  const std::string name = part.substr(0, equals), value = part.substr(equals + 1);
  const auto key = keys().find(name);
  if (key == keys().end())
    options.controls.emplace_back(name, value);  // the device says whether it has it
  else if (!key->second.take(options, value))
    throw ConfigError(fmt::format("{}: {}={} is no such value; write for instance {}={} ({})", source, name, value,
                                  name, key->second.form, key->second.help));
}

}  // namespace

bool is_camera(const std::string& source) { return source.rfind(PREFIX, 0) == 0; }

CameraOptions parse_camera(const std::string& source) {
  CameraOptions options;
  const std::string text = is_camera(source) ? source.substr(std::string(PREFIX).size()) : source;
  auto comma = std::min(text.find(','), text.size());
  options.device = text.substr(0, comma);
  if (options.device.empty()) throw ConfigError(source + ": names no device; write for instance v4l2:/dev/video0");
  while (comma < text.size()) {
    const auto next = std::min(text.find(',', comma + 1), text.size());
    take(options, text.substr(comma + 1, next - comma - 1), source);
    comma = next;
  }
  return options;
}

std::string camera_option_help() {
  std::string text = "after the device, separated by commas:\n";
  for (const auto& [name, key] : keys())
    text += fmt::format("  {:<24}{}\n", fmt::format("{}={}", name, key.form), key.help);
  return text + "  CONTROL=VALUE           a control of the device, as --probe lists them: exposure_time_absolute=80\n";
}

}  // namespace heartservo::tracking::v4l2
