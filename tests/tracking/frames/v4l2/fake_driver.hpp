#pragma once
// A camera's driver as V4L2 shows it, on a clock that stands still until somebody waits. What real drivers were seen to
// do on faults is done to it at given times.
#include <linux/videodev2.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "tracking/frames/v4l2/system_calls.hpp"

namespace heartservo::test {

class FakeDriver final : public tracking::v4l2::SystemCalls {
 public:
  // --- what the device is; set before it is opened
  std::uint32_t fourcc = V4L2_PIX_FMT_GREY;
  int width = 64, height = 48, line_padding = 0;
  double rate_hz = 50;
  std::uint32_t field = V4L2_FIELD_NONE;
  bool scales_fields = false;  ///< makes a single field as high as it is asked to
  bool dv = false;             ///< an HDMI input, else a webcam
  bool source_change_events = false;
  bool real_time = false;  ///< waits really
  std::uint32_t first_sequence = 0;
  std::uint32_t stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
  double stamp_offset_s = 0;  ///< added to every time stamp
  std::int32_t exposure_100us = 0, gain = 10;
  int max_gain = 100;
  std::vector<std::uint8_t> payload;  ///< of a compressed format; else pictures are made

  // --- its state, for faults
  bool plugged = true, node = true, frozen_picture = false, stalled = false, dead = false, lying_poll = false;
  int signal_error = 0;  ///< of QUERY_DV_TIMINGS
  std::uint32_t input_status = 0;
  int signal_width = 64, signal_height = 48;
  double signal_rate_hz = 50;
  bool broken_signal_stops = false;
  int bad_buffers = 0, drop = 0, empty_buffers = 0, short_buffers = 0;
  int open_error = 0, stream_on_error = 0;

  // --- what was done to it
  int opens = 0, starts = 0, timings_set = 0, polls = 0, ioctls = 0, mapped = 0;

  /// Does something to the device at a time (s since the start).
  void at(double time_s, std::function<void(FakeDriver&)> what) { plan_.emplace(time_s + begin_s_, std::move(what)); }

  int open(const std::string&) override {
    const std::lock_guard lock(mutex_);
    advance(0);
    if (open_error) return -open_error;
    if (!node) return -ENOENT;
    if (!plugged) return -ENODEV;
    ++opens;
    fd_ = 7;
    gone_ = dead = false;
    return fd_;
  }
  int close(int) override {
    const std::lock_guard lock(mutex_);
    streaming_ = false;
    fd_ = -1;
    return 0;
  }
  void* mmap(int, std::size_t length, std::int64_t offset) override {
    const std::lock_guard lock(mutex_);
    auto& memory = memory_[static_cast<std::size_t>(offset) / 4096];
    memory.resize(length);
    ++mapped;
    return memory.data();
  }
  int munmap(void*, std::size_t) override { return --mapped, 0; }
  bool exists(const std::string&) override { return node; }
  double now_s() override {
    const std::lock_guard lock(mutex_);
    return now_;
  }
  void sleep(double seconds) override {
    const std::lock_guard lock(mutex_);
    advance(seconds);
  }
  int poll(int, int timeout_ms, short& events) override {
    const std::lock_guard lock(mutex_);
    ++polls;
    events = 0;
    const double end = now_ + 1e-3 * timeout_ms;
    while (true) {
      if (gone_)
        events = POLLERR | POLLHUP;
      else if (dead)
        events = POLLERR;
      else if (lying_poll || !filled_.empty())
        events = POLLIN;
      if (event_pending_) events |= POLLPRI;
      if (events) return 1;
      if (now_ >= end) return 0;
      advance(std::min(0.001, end - now_ + 1e-9));
    }
  }
  int ioctl(int fd, unsigned long request, void* argument) override {
    const std::lock_guard lock(mutex_);
    ++ioctls;
    advance(1e-5);
    if (fd != fd_ || gone_) return -ENODEV;
    return answer(request, argument);
  }

 private:
  void advance(double seconds) {
    if (real_time && seconds > 0) std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    const double end = now_ + seconds;
    while (true) {
      const double fault = plan_.empty() ? 1e300 : plan_.begin()->first;
      const double next = std::min(fault, streaming_ ? due_ : 1e300);
      if (next > end) break;
      now_ = std::max(now_, next);
      if (fault <= next) {
        const auto what = plan_.begin()->second;
        plan_.erase(plan_.begin());
        what(*this);
        if (!plugged) gone_ = fd_ >= 0;
        if (gone_) streaming_ = false;
      } else {
        due_ += 1 / rate_hz;
        expose();
      }
    }
    now_ = end;
  }

  // One frame time passes.
  void expose() {
    const std::uint32_t number = sequence_++;
    if (stalled || dead || (signal_error && broken_signal_stops)) return;
    if (drop > 0) return static_cast<void>(--drop);
    if (queued_.empty()) return;  // the consumer is too slow
    v4l2_buffer buffer{};
    buffer.index = queued_.front();
    queued_.pop_front();
    buffer.flags = stamp_flags;
    buffer.sequence = number;
    buffer.field = field;
    if (field == V4L2_FIELD_ALTERNATE) buffer.field = number % 2 ? V4L2_FIELD_BOTTOM : V4L2_FIELD_TOP;
    const double stamp = now_ + stamp_offset_s;
    buffer.timestamp.tv_sec = static_cast<time_t>(stamp);
    buffer.timestamp.tv_usec = static_cast<suseconds_t>(1e6 * (stamp - static_cast<double>(buffer.timestamp.tv_sec)));
    buffer.bytesused = static_cast<std::uint32_t>(bytes());
    if (!frozen_picture) ++picture_;
    paint(memory_[buffer.index]);
    if (bad_buffers > 0)
      --bad_buffers, buffer.flags |= V4L2_BUF_FLAG_ERROR, buffer.bytesused = 0, buffer.sequence = 0,
                                                          buffer.timestamp = {};
    else if (empty_buffers > 0)
      --empty_buffers, buffer.bytesused = 0;
    else if (short_buffers > 0)
      --short_buffers, buffer.bytesused /= 2;
    filled_.push_back(buffer);
  }

  int lines() const {
    if (field != V4L2_FIELD_ALTERNATE) return height;
    return field_lines_ > 0 ? field_lines_ : height / 2;
  }
  std::size_t pixel_bytes() const {
    return fourcc == V4L2_PIX_FMT_RGB24 || fourcc == V4L2_PIX_FMT_BGR24 ? 3
           : fourcc == V4L2_PIX_FMT_YUYV || fourcc == V4L2_PIX_FMT_UYVY ? 2
                                                                        : 1;
  }
  std::size_t line_bytes() const {
    return static_cast<std::size_t>(width) * pixel_bytes() + static_cast<std::size_t>(line_padding);
  }
  std::size_t bytes() const {
    if (!payload.empty()) return payload.size();
    const std::size_t plane = line_bytes() * static_cast<std::size_t>(lines());
    return fourcc == V4L2_PIX_FMT_NV12 || fourcc == V4L2_PIX_FMT_YUV420 ? plane * 3 / 2 : plane;
  }
  void paint(std::vector<std::uint8_t>& memory) const {
    if (!payload.empty()) return static_cast<void>(std::copy(payload.begin(), payload.end(), memory.begin()));
    std::fill(memory.begin(), memory.end(), static_cast<std::uint8_t>(100));
    memory[0] = static_cast<std::uint8_t>(picture_ % 251);  // tells pictures apart
  }

  v4l2_dv_timings timings() const {
    v4l2_dv_timings t{};
    t.type = V4L2_DV_BT_656_1120;
    t.bt.width = static_cast<std::uint32_t>(signal_width);
    t.bt.height = static_cast<std::uint32_t>(signal_height);
    t.bt.pixelclock = static_cast<std::uint64_t>(signal_width * signal_height * signal_rate_hz);
    return t;
  }

  int answer(unsigned long request, void* argument) {
    switch (request) {
      case VIDIOC_QUERYCAP: {
        auto& c = *static_cast<v4l2_capability*>(argument);
        c = {};
        std::strcpy(reinterpret_cast<char*>(c.driver), "fake");
        std::strcpy(reinterpret_cast<char*>(c.card), "Fake Endoscope");
        c.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
        c.capabilities = c.device_caps | V4L2_CAP_DEVICE_CAPS;
        return 0;
      }
      case VIDIOC_ENUMINPUT: {
        auto& i = *static_cast<v4l2_input*>(argument);
        if (i.index > 1) return -EINVAL;
        std::strcpy(reinterpret_cast<char*>(i.name), i.index == 0 ? (dv ? "HDMI 0" : "Webcam 0") : "S-Video 0");
        i.status = input_status;
        return 0;
      }
      case VIDIOC_G_INPUT:
        return *static_cast<int*>(argument) = input_, 0;
      case VIDIOC_S_INPUT:
        return input_ = *static_cast<int*>(argument), 0;
      case VIDIOC_QUERY_DV_TIMINGS:
        if (!dv) return -ENODATA;
        if (signal_error) return -signal_error;
        return *static_cast<v4l2_dv_timings*>(argument) = timings(), 0;
      case VIDIOC_G_DV_TIMINGS:
        return dv ? (*static_cast<v4l2_dv_timings*>(argument) = timings(), 0) : -ENODATA;
      case VIDIOC_S_DV_TIMINGS: {
        const auto& bt = static_cast<v4l2_dv_timings*>(argument)->bt;
        width = static_cast<int>(bt.width), height = static_cast<int>(bt.height);
        return ++timings_set, 0;
      }
      case VIDIOC_ENUM_FMT: {
        auto& d = *static_cast<v4l2_fmtdesc*>(argument);
        if (d.index > 0) return -EINVAL;
        d.pixelformat = fourcc;
        return 0;
      }
      case VIDIOC_G_FMT:
      case VIDIOC_S_FMT: {
        auto& pix = static_cast<v4l2_format*>(argument)->fmt.pix;
        if (request == VIDIOC_S_FMT && scales_fields) field_lines_ = static_cast<int>(pix.height);
        pix = {};
        pix.width = static_cast<std::uint32_t>(width);
        pix.height = static_cast<std::uint32_t>(lines());
        pix.pixelformat = fourcc;
        pix.field = field;
        pix.bytesperline = static_cast<std::uint32_t>(line_bytes());
        pix.sizeimage = static_cast<std::uint32_t>(bytes());
        return 0;
      }
      case VIDIOC_G_PARM:
      case VIDIOC_S_PARM:
        static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe = {
            1000, static_cast<std::uint32_t>(1000 * rate_hz)};
        return 0;
      case VIDIOC_QUERYCTRL: {
        auto& q = *static_cast<v4l2_queryctrl*>(argument);
        if ((q.id & ~V4L2_CTRL_FLAG_NEXT_CTRL) >= V4L2_CID_GAIN) return -EINVAL;
        q = {};
        q.id = V4L2_CID_GAIN;
        q.type = V4L2_CTRL_TYPE_INTEGER;
        q.minimum = 0, q.maximum = 1000, q.step = 1;
        std::strcpy(reinterpret_cast<char*>(q.name), "Gain, Analogue");
        return 0;
      }
      case VIDIOC_G_CTRL: {
        auto& c = *static_cast<v4l2_control*>(argument);
        if (c.id == V4L2_CID_GAIN) return c.value = gain, 0;
        if (c.id == V4L2_CID_EXPOSURE_ABSOLUTE && exposure_100us) return c.value = exposure_100us, 0;
        return -EINVAL;
      }
      case VIDIOC_S_CTRL: {
        const auto& c = *static_cast<v4l2_control*>(argument);
        return gain = std::min(c.value, max_gain), 0;
      }
      case VIDIOC_REQBUFS: {
        auto& r = *static_cast<v4l2_requestbuffers*>(argument);
        queued_.clear();
        filled_.clear();
        r.count = std::min(r.count, 4u);  // a driver may grant fewer
        return 0;
      }
      case VIDIOC_QUERYBUF: {
        auto& b = *static_cast<v4l2_buffer*>(argument);
        b.length =
            static_cast<std::uint32_t>(payload.empty() ? bytes() : std::max<std::size_t>(payload.size(), 1 << 16));
        b.m.offset = b.index * 4096;
        return 0;
      }
      case VIDIOC_QBUF:
        return queued_.push_back(static_cast<v4l2_buffer*>(argument)->index), 0;
      case VIDIOC_STREAMON:
        if (stream_on_error) return -stream_on_error;
        if (!streaming_) sequence_ = first_sequence;
        streaming_ = true, dead = false, ++starts;
        due_ = now_ + 1 / rate_hz;
        return 0;
      case VIDIOC_STREAMOFF:
        return streaming_ = false, 0;
      case VIDIOC_DQBUF: {
        if (dead) return -EIO;
        if (lying_poll || filled_.empty()) return -EAGAIN;
        *static_cast<v4l2_buffer*>(argument) = filled_.front();
        filled_.pop_front();
        return 0;
      }
      case VIDIOC_SUBSCRIBE_EVENT:
        return source_change_events ? 0 : -EINVAL;
      case VIDIOC_DQEVENT:
        if (!event_pending_) return -ENOENT;
        event_pending_ = false;
        static_cast<v4l2_event*>(argument)->type = V4L2_EVENT_SOURCE_CHANGE;
        return 0;
      default:
        return -ENOTTY;
    }
  }

  std::mutex mutex_;
  const double begin_s_ = 1000;
  double now_ = begin_s_, due_ = 0;
  int fd_ = -1, input_ = 0, field_lines_ = 0;
  bool streaming_ = false, gone_ = false;
  std::uint32_t sequence_ = 0, picture_ = 0;
  std::multimap<double, std::function<void(FakeDriver&)>> plan_;
  std::deque<std::uint32_t> queued_;
  std::deque<v4l2_buffer> filled_;
  std::map<std::size_t, std::vector<std::uint8_t>> memory_;

 public:
  bool event_pending_ = false;
};

}  // namespace heartservo::test
