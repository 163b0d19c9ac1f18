#include "tracking/frames/v4l2/controls.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <cctype>
#include <charconv>
#include <cstring>

#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::tracking::v4l2 {

namespace {

constexpr int MOST_CONTROLS = 500;  // a driver that never ends its list

std::string normalised(const char* name) {
  std::string result;
  for (; *name != '\0'; ++name) {
    const auto c = static_cast<unsigned char>(*name);
    if (std::isalnum(c))
      result += static_cast<char>(std::tolower(c));
    else if (!result.empty() && result.back() != '_')
      result += '_';
  }
  if (!result.empty() && result.back() == '_') result.pop_back();
  return result;
}

int value_of(SystemCalls& calls, int fd, std::uint32_t id, std::int32_t& value) {
  v4l2_control control{};
  control.id = id;
  const int result = calls.ioctl(fd, VIDIOC_G_CTRL, &control);
  value = control.value;
  return result;
}

Control described(SystemCalls& calls, int fd, const v4l2_queryctrl& query) {
  Control control{query.id,
                  normalised(reinterpret_cast<const char*>(query.name)),
                  query.minimum,
                  query.maximum,
                  query.step,
                  query.default_value,
                  query.default_value,
                  {}};
  value_of(calls, fd, query.id, control.value);
  if (query.type != V4L2_CTRL_TYPE_MENU) return control;
  for (std::int32_t i = query.minimum; i <= query.maximum && i - query.minimum < MOST_CONTROLS; ++i) {
    v4l2_querymenu item{};
    item.id = query.id;
    item.index = static_cast<std::uint32_t>(i);
    const bool there = calls.ioctl(fd, VIDIOC_QUERYMENU, &item) == 0;
    control.menu.push_back(there ? normalised(reinterpret_cast<const char*>(item.name)) : "");
  }
  return control;
}

// The number that a text stands for: itself, or the name of a menu's value.
std::int32_t number_of(const Control& control, const std::string& text, const std::string& device) {
  for (std::size_t i = 0; i < control.menu.size(); ++i)
    if (!text.empty() && control.menu[i] == normalised(text.c_str())) return control.low + static_cast<std::int32_t>(i);
  std::int32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < control.low || value > control.high)
    throw ConfigError(fmt::format("{}: {}={}: give a whole number from {} to {}", device, control.name, text,
                                  control.low, control.high));
  return value;
}

const Control& named(const std::vector<Control>& controls, const std::string& name, const std::string& device) {
  std::vector<std::string> names;
  for (const auto& control : controls) {
    if (control.name == name) return control;
    names.push_back(control.name);
  }
  for (const char* option : {"format", "size", "rate", "input", "fields", "crop", "frames"}) names.emplace_back(option);
  throw ConfigError(
      fmt::format("{}: has no control and we have no option '{}'{}; 'heartservo capture --probe {}' lists them", device,
                  name, did_you_mean(name, names), device));
}

}  // namespace

std::vector<Control> controls_of(SystemCalls& calls, int fd) {
  std::vector<Control> controls;
  v4l2_queryctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  for (int i = 0; i < MOST_CONTROLS && calls.ioctl(fd, VIDIOC_QUERYCTRL, &query) == 0; ++i) {
    const bool is_number = query.type == V4L2_CTRL_TYPE_INTEGER || query.type == V4L2_CTRL_TYPE_BOOLEAN ||
                           query.type == V4L2_CTRL_TYPE_MENU || query.type == V4L2_CTRL_TYPE_INTEGER_MENU ||
                           query.type == V4L2_CTRL_TYPE_BITMASK;
    if (is_number && !(query.flags & V4L2_CTRL_FLAG_DISABLED)) controls.push_back(described(calls, fd, query));
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  return controls;
}

std::vector<std::string> set_controls(SystemCalls& calls, int fd, const std::string& device,
                                      const std::vector<std::pair<std::string, std::string>>& wanted) {
  std::vector<std::string> lines;
  if (wanted.empty()) return lines;
  const auto controls = controls_of(calls, fd);
  for (const auto& [name, text] : wanted) {
    const Control& control = named(controls, name, device);
    v4l2_control set{};
    set.id = control.id;
    set.value = number_of(control, text, device);
    const int result = calls.ioctl(fd, VIDIOC_S_CTRL, &set);
    if (result < 0)
      throw ConfigError(fmt::format("{}: {}={} is refused: {}", device, name, text, std::strerror(-result)));
    std::int32_t granted = set.value;
    value_of(calls, fd, control.id, granted);
    const std::string value = std::to_string(set.value);
    lines.push_back(granted == set.value ? fmt::format("{}={}", name, value)
                                         : fmt::format("{}={} -> {}", name, value, granted));
  }
  return lines;
}

double exposure_s(SystemCalls& calls, int fd) {
  std::int32_t units = 0;  // of 100 us
  return value_of(calls, fd, V4L2_CID_EXPOSURE_ABSOLUTE, units) == 0 && units > 0 ? 1e-4 * units : 0;
}

}  // namespace heartservo::tracking::v4l2
