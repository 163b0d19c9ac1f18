#include "tracking/frames/v4l2/signal.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>

namespace heartservo::tracking::v4l2 {

namespace {

Timings timings_from(const v4l2_dv_timings& raw) {
  const v4l2_bt_timings& bt = raw.bt;
  Timings timings;
  timings.raw = raw;
  timings.size = {static_cast<int>(bt.width), static_cast<int>(bt.height)};
  timings.interlaced = bt.interlaced == V4L2_DV_INTERLACED;
  const double total = static_cast<double>(V4L2_DV_BT_FRAME_WIDTH(&bt)) * V4L2_DV_BT_FRAME_HEIGHT(&bt);
  if (total > 0) timings.rate_hz = static_cast<double>(bt.pixelclock) / total;
  return timings;
}

// The status of an analogue or unknown input.
std::optional<Event> input_fault(std::uint32_t status) {
  if (status & (V4L2_IN_ST_NO_POWER | V4L2_IN_ST_NO_SIGNAL)) return Event::NO_SIGNAL;
  if (status & (V4L2_IN_ST_NO_H_LOCK | V4L2_IN_ST_NO_V_LOCK | V4L2_IN_ST_NO_SYNC)) return Event::NO_LOCK;
  return std::nullopt;
}

}  // namespace

std::string Timings::text() const {
  return fmt::format("{}x{}{} {:.2f} Hz", size.width, size.height, interlaced ? "i" : "p", rate_hz);
}

bool Timings::same_as(const Timings& other) const {
  return size == other.size && interlaced == other.interlaced && std::abs(rate_hz - other.rate_hz) < 0.5;
}

Signal signal_of(SystemCalls& calls, int fd) {
  Signal signal;
  v4l2_dv_timings raw{};
  switch (calls.ioctl(fd, VIDIOC_QUERY_DV_TIMINGS, &raw)) {
    case 0:
      signal.timings = timings_from(raw);
      return signal;
    case -ENOLINK:
      signal.fault = Event::NO_SIGNAL;
      return signal;
    case -ENOLCK:
      signal.fault = Event::NO_LOCK;
      return signal;
    case -ERANGE:
      signal.fault = Event::OUT_OF_RANGE;
      return signal;
    default:
      break;  // no digital input
  }
  v4l2_input input{};
  int index = 0;
  if (calls.ioctl(fd, VIDIOC_G_INPUT, &index) < 0) return signal;
  input.index = static_cast<std::uint32_t>(index);
  if (calls.ioctl(fd, VIDIOC_ENUMINPUT, &input) == 0) signal.fault = input_fault(input.status);
  return signal;
}

std::optional<Timings> timings_set(SystemCalls& calls, int fd) {
  v4l2_dv_timings raw{};
  if (calls.ioctl(fd, VIDIOC_G_DV_TIMINGS, &raw) < 0) return std::nullopt;
  return timings_from(raw);
}

int set_timings(SystemCalls& calls, int fd, const Timings& timings) {
  v4l2_dv_timings raw = timings.raw;
  return calls.ioctl(fd, VIDIOC_S_DV_TIMINGS, &raw);
}

}  // namespace heartservo::tracking::v4l2
