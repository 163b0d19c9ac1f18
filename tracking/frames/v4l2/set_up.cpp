#include "tracking/frames/v4l2/set_up.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "tracking/frames/v4l2/controls.hpp"
#include "tracking/frames/v4l2/formats.hpp"
#include "tracking/frames/v4l2/offers.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking::v4l2 {

namespace {

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

void choose_input(SystemCalls& calls, int fd, const CameraOptions& options, DeviceOffer& offer) {
  if (!options.input.empty()) {
    const auto found = std::find_if(offer.inputs.begin(), offer.inputs.end(), [&](const InputOffer& input) {
      return options.input == std::to_string(input.index) ||
             lower(input.name).find(lower(options.input)) != std::string::npos;
    });
    if (found == offer.inputs.end()) {
      std::vector<std::string> names;
      for (const auto& input : offer.inputs) names.push_back(fmt::format("{} ({})", input.index, input.name));
      throw ConfigError(fmt::format("{}: has no input '{}'; it has {}", offer.device, options.input,
                                    names.empty() ? "none to choose" : fmt::format("{}", fmt::join(names, ", "))));
    }
    int index = static_cast<int>(found->index);
    if (const int result = calls.ioctl(fd, VIDIOC_S_INPUT, &index); result < 0)
      throw DeviceError(
          fmt::format("{}: input {} cannot be chosen: {}", offer.device, found->name, std::strerror(-result)));
    offer = offer_of(calls, fd, offer.device);  // formats and sizes are the input's
  }
}

std::uint32_t choose_format(const CameraOptions& options, const DeviceOffer& offer) {
  const FormatOffer *first = nullptr, *foreign = nullptr;
  for (const std::string& name : format_names())
    for (const FormatOffer& format : offer.formats) {
      if (format.emulated || (format.name != name && !(name == "MJPG" && format.name == "JPEG"))) continue;
      if (!options.format.empty() && options.format != name) continue;
      if (format.offers(options.size, options.rate_hz)) return format.fourcc;
      if (!first) first = &format;
    }
  if (first) return first->fourcc;
  for (const FormatOffer& format : offer.formats)
    if (!format.decoded) foreign = &format;
  // what only libv4l2 can convert (Bayer and the like) it gives as YU12 or the wanted format
  if (foreign || offer.formats.empty()) return options.format.empty() ? V4L2_PIX_FMT_YUV420 : fourcc_of(options.format);
  std::vector<std::string> names;
  for (const auto& format : offer.formats) names.push_back(format.name);
  throw DeviceError(
      fmt::format("{}: has no format {}; it has {}", offer.device, options.format, fmt::join(names, ", ")));
}

void set_format(SystemCalls& calls, int fd, const CameraOptions& options, std::uint32_t fourcc, Granted& granted) {
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int result = calls.ioctl(fd, VIDIOC_G_FMT, &format); result < 0)
    throw DeviceError(fmt::format("{}: tells no format: {}", granted.device, std::strerror(-result)));
  v4l2_pix_format& pix = format.fmt.pix;
  pix.pixelformat = fourcc;
  pix.bytesperline = pix.sizeimage = 0;
  pix.field = V4L2_FIELD_ANY;
  if (granted.timings) {
    pix.width = static_cast<std::uint32_t>(granted.timings->size.width);
    pix.height = static_cast<std::uint32_t>(granted.timings->size.height);
  } else if (options.size.area() > 0) {
    pix.width = static_cast<std::uint32_t>(options.size.width);
    pix.height = static_cast<std::uint32_t>(options.size.height);
  }
  int result = calls.ioctl(fd, VIDIOC_S_FMT, &format);
  // A single field has half the lines; a device that can scale makes whole pictures of it when asked for the signal's.
  if (result >= 0 && granted.timings && is_single_field(pix.field) &&
      pix.height == static_cast<std::uint32_t>(granted.timings->size.height)) {
    pix.height /= 2;
    pix.bytesperline = pix.sizeimage = 0;
    result = calls.ioctl(fd, VIDIOC_S_FMT, &format);
  }
  if (result < 0)
    throw DeviceError(fmt::format("{}: refuses {}: {}{}", granted.device, fourcc_name(fourcc), std::strerror(-result),
                                  result == -EBUSY ? "; another program uses the device" : ""));
  if (!can_decode(pix.pixelformat))
    throw DeviceError(fmt::format("{}: gives only {}, which cannot be decoded; choose among {}", granted.device,
                                  fourcc_name(pix.pixelformat), fmt::join(format_names(), ", ")));
  granted.fourcc = pix.pixelformat;
  granted.field = pix.field;
  granted.size = {static_cast<int>(pix.width), static_cast<int>(pix.height)};
  granted.bytes_per_line = pix.bytesperline;
  granted.bytes = pix.sizeimage;
  granted.quantisation = pix.quantization;
  if (is_single_field(granted.field)) granted.size.height *= 2;
}

double set_rate(SystemCalls& calls, int fd, double wanted_hz) {
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  v4l2_fract& interval = parameters.parm.capture.timeperframe;
  if (wanted_hz > 0) {
    interval = {1000, static_cast<std::uint32_t>(std::lround(1000 * wanted_hz))};
    calls.ioctl(fd, VIDIOC_S_PARM, &parameters);  // a device without rates keeps its own
  }
  if (calls.ioctl(fd, VIDIOC_G_PARM, &parameters) < 0 || interval.numerator == 0) return 0;
  return static_cast<double>(interval.denominator) / interval.numerator;
}

const char* field_text(std::uint32_t field) {
  if (is_single_field(field)) return "single fields";
  return field == V4L2_FIELD_NONE || field == V4L2_FIELD_ANY ? "progressive" : "interlaced";
}

}  // namespace

bool is_single_field(std::uint32_t field) {
  return field == V4L2_FIELD_ALTERNATE || field == V4L2_FIELD_TOP || field == V4L2_FIELD_BOTTOM;
}

std::string Granted::format() const {
  return fmt::format("{} {}x{}{}, {}", fourcc_name(fourcc), size.width, size.height,
                     rate_hz > 0 ? fmt::format(" at {:.2f} Hz", rate_hz) : "", field_text(field));
}

Granted set_up(SystemCalls& calls, int fd, const CameraOptions& options) {
  DeviceOffer offer = offer_of(calls, fd, options.device);
  choose_input(calls, fd, options, offer);
  Granted granted;
  granted.device = offer.device;
  granted.driver = offer.driver;
  granted.card = offer.card;
  granted.bus = offer.bus;
  for (const auto& input : offer.inputs)
    if (input.index == offer.input) granted.input = input.name;
  const Signal signal = signal_of(calls, fd);
  if (signal.timings) {
    if (const int result = set_timings(calls, fd, *signal.timings); result < 0)
      throw DeviceError(fmt::format("{}: the signal's timings ({}) cannot be set: {}", offer.device,
                                    signal.timings->text(), std::strerror(-result)));
    granted.timings = signal.timings;
  } else if (signal.fault) {
    granted.timings = timings_set(calls, fd);  // those of before; the signal may come
  }
  set_format(calls, fd, options, choose_format(options, offer), granted);
  if (options.fields == "refuse" && granted.field != V4L2_FIELD_NONE)
    throw DeviceError(
        fmt::format("{}: sends interlaced pictures ({}), which fields=refuse refuses; let the source send "
                    "progressive ones, or use fields=double",
                    offer.device, granted.format()));
  granted.rate_hz = set_rate(calls, fd, granted.timings ? 0 : options.rate_hz);
  if (granted.timings && granted.timings->rate_hz > 0)
    granted.rate_hz = granted.timings->rate_hz * (is_single_field(granted.field) ? 2 : 1);
  granted.controls = set_controls(calls, fd, offer.device, options.controls);
  granted.exposure_s = exposure_s(calls, fd);
  return granted;
}

}  // namespace heartservo::tracking::v4l2
