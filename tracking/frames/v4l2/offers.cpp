#include "tracking/frames/v4l2/offers.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tracking/frames/image_folder.hpp"
#include "tracking/frames/v4l2/formats.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking::v4l2 {

namespace {

constexpr std::uint32_t MOST = 200;  // entries of a list that a driver does not end

double rate_of(const v4l2_fract& interval) {
  return interval.numerator > 0 ? static_cast<double>(interval.denominator) / interval.numerator : 0;
}

void add_rates(SystemCalls& calls, int fd, std::uint32_t fourcc, SizeOffer& size) {
  v4l2_frmivalenum interval{};
  interval.pixel_format = fourcc;
  interval.width = static_cast<std::uint32_t>(size.low.width);
  interval.height = static_cast<std::uint32_t>(size.low.height);
  for (; interval.index < MOST && calls.ioctl(fd, VIDIOC_ENUM_FRAMEINTERVALS, &interval) == 0; ++interval.index) {
    if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) {
      size.rates = {rate_of(interval.stepwise.max), rate_of(interval.stepwise.min)};
      size.rates_are_range = true;
      return;
    }
    size.rates.push_back(rate_of(interval.discrete));
  }
}

void add_sizes(SystemCalls& calls, int fd, FormatOffer& format) {
  v4l2_frmsizeenum entry{};
  entry.pixel_format = format.fourcc;
  const auto size = [](std::uint32_t w, std::uint32_t h) { return cv::Size(static_cast<int>(w), static_cast<int>(h)); };
  for (; entry.index < MOST && calls.ioctl(fd, VIDIOC_ENUM_FRAMESIZES, &entry) == 0; ++entry.index) {
    const bool discrete = entry.type == V4L2_FRMSIZE_TYPE_DISCRETE;
    SizeOffer offer;
    offer.low = discrete ? size(entry.discrete.width, entry.discrete.height)
                         : size(entry.stepwise.min_width, entry.stepwise.min_height);
    offer.high = discrete ? offer.low : size(entry.stepwise.max_width, entry.stepwise.max_height);
    add_rates(calls, fd, format.fourcc, offer);
    format.sizes.push_back(offer);
    if (!discrete) return;
  }
}

std::string state_of(std::uint32_t status) {
  if (status & (V4L2_IN_ST_NO_POWER | V4L2_IN_ST_NO_SIGNAL)) return "no_signal";
  return status & (V4L2_IN_ST_NO_H_LOCK | V4L2_IN_ST_NO_SYNC) ? "no_lock" : "";
}

}  // namespace

bool FormatOffer::offers(cv::Size size, double rate_hz) const {
  if (sizes.empty()) return true;  // an HDMI input lists none: they are the signal's
  return std::any_of(sizes.begin(), sizes.end(), [&](const SizeOffer& s) {
    const bool fits = size.area() == 0 || (size.width >= s.low.width && size.width <= s.high.width &&
                                           size.height >= s.low.height && size.height <= s.high.height);
    const bool fast = rate_hz <= 0 || s.rates.empty() ||
                      std::any_of(s.rates.begin(), s.rates.end(), [&](double r) { return r > 0.98 * rate_hz; });
    return fits && fast;
  });
}

std::vector<InputOffer> inputs_of(SystemCalls& calls, int fd) {
  std::vector<InputOffer> inputs;
  v4l2_input input{};
  for (std::uint32_t i = 0; i < MOST; ++i) {
    input = {};
    input.index = i;
    if (calls.ioctl(fd, VIDIOC_ENUMINPUT, &input) != 0) break;
    inputs.push_back({i, reinterpret_cast<const char*>(input.name), state_of(input.status)});
  }
  return inputs;
}

DeviceOffer offer_of(SystemCalls& calls, int fd, const std::string& device) {
  v4l2_capability capability{};
  if (calls.ioctl(fd, VIDIOC_QUERYCAP, &capability) < 0)
    throw DeviceError(device + ": is no video device; 'heartservo capture --list' shows what there is");
  const std::uint32_t can =
      capability.capabilities & V4L2_CAP_DEVICE_CAPS ? capability.device_caps : capability.capabilities;
  const auto text = [](const auto& bytes) { return std::string(reinterpret_cast<const char*>(bytes)); };
  DeviceOffer offer{device, text(capability.driver), text(capability.card), text(capability.bus_info), {}, 0, {}};
  if (!(can & V4L2_CAP_VIDEO_CAPTURE) || !(can & V4L2_CAP_STREAMING))
    throw DeviceError(fmt::format("{}: {} cannot capture by streaming; 'heartservo capture --list' shows what can",
                                  device, offer.card));
  offer.inputs = inputs_of(calls, fd);
  int chosen = 0;
  if (calls.ioctl(fd, VIDIOC_G_INPUT, &chosen) == 0) offer.input = static_cast<std::uint32_t>(chosen);
  for (std::uint32_t i = 0; i < MOST; ++i) {
    v4l2_fmtdesc description{};
    description.index = i;
    description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (calls.ioctl(fd, VIDIOC_ENUM_FMT, &description) != 0) break;
    FormatOffer format;
    format.fourcc = description.pixelformat;
    format.name = fourcc_name(format.fourcc);
    format.description = text(description.description);
    format.decoded = can_decode(format.fourcc);
    format.emulated = description.flags & V4L2_FMT_FLAG_EMULATED;
    add_sizes(calls, fd, format);
    offer.formats.push_back(std::move(format));
  }
  return offer;
}

std::vector<std::string> video_devices() {
  std::vector<std::string> devices;
  std::error_code error;
  for (std::filesystem::directory_iterator entry("/dev", error), end; !error && entry != end; entry.increment(error))
    if (entry->path().filename().string().rfind("video", 0) == 0) devices.push_back(entry->path().string());
  std::sort(devices.begin(), devices.end(), natural_less);
  return devices;
}

}  // namespace heartservo::tracking::v4l2
