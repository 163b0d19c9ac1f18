#include "tracking/frames/v4l2/capture_core.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "tracking/frames/v4l2/formats.hpp"
#include "tracking/frames/v4l2/round_picture.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking::v4l2 {

namespace {

constexpr int WAIT_MS = 50;       // of one step for a frame
constexpr double IDLE_s = 0.001;  // between looks at a device that says it has a frame and has none

}  // namespace

CaptureCore::CaptureCore(SystemCalls& calls, const CameraOptions& options, bool with_colour)
    : calls_(calls), options_(options), with_colour_(with_colour), origin_s_(calls.now_s()) {}

CaptureCore::~CaptureCore() { disconnect(); }

void CaptureCore::open() {
  connect();
  last_good_s_ = calls_.now_s();
}

void CaptureCore::connect() {
  fd_ = calls_.open(options_.device);
  if (fd_ < 0) {
    const int error = fd_;
    fd_ = -1;
    const char* advice = error == -ENOENT   ? "'heartservo capture --list' shows what there is"
                         : error == -EACCES ? "you need to be of the group 'video'"
                         : error == -EBUSY  ? "another program uses it"
                                            : "is it a video device?";
    throw DeviceError(fmt::format("{}: cannot be opened: {}; {}", options_.device, std::strerror(-error), advice));
  }
  try {
    Granted granted = set_up(calls_, fd_, options_);
    v4l2_event_subscription subscription{};
    subscription.type = V4L2_EVENT_SOURCE_CHANGE;
    calls_.ioctl(fd_, VIDIOC_SUBSCRIBE_EVENT, &subscription);  // only some drivers have it; we look ourselves as well
    decoder_.emplace(granted, crop_);
    ring_.emplace(calls_, fd_);
    if (const int result = ring_->start(options_.buffers); result < 0)
      throw DeviceError(fmt::format("{}: the stream does not start: {}{}", options_.device, std::strerror(-result),
                                    result == -EBUSY ? "; another program uses the device" : ""));
    const std::lock_guard lock(facts_);
    granted_ = std::move(granted);
  } catch (...) {
    disconnect();
    throw;
  }
  clock_.restart();
  sequence_.restart();
  freeze_.restart();
  statistics_.interrupted();
  changed_.reset();
  bad_in_row_ = 0;
  next_signal_check_s_ = 0;
}

void CaptureCore::disconnect() {
  ring_.reset();
  decoder_.reset();
  if (fd_ >= 0) calls_.close(fd_);
  fd_ = -1;
}

bool CaptureCore::step(Frame& frame) {
  if (gave_up_) return false;
  if (fd_ < 0) return reopen(), false;
  if (calls_.now_s() >= next_signal_check_s_) check_signal();
  if (fd_ < 0) return false;
  short events = 0;
  const int result = calls_.poll(fd_, WAIT_MS, events);
  polled_readable_ = result > 0 && (events & POLLIN);
  if (result < 0 && result != -EINTR) return fail(result), false;
  if (result <= 0) return watch_for_starving(), false;
  if (events & POLLPRI) take_device_events();
  if (fd_ < 0) return false;
  Filled best;
  bool any = false;
  for (int i = 0; i < 2 * ring_->size(); ++i) {  // more come only from a driver that never ends
    Filled filled;
    const int error = ring_->take(filled);
    if (error == -EAGAIN) break;
    if (error < 0) return fail(error), false;
    if (!usable(filled)) {
      ring_->give_back(filled);
      if (bad_in_row_ >= ring_->size()) return restart("all buffers came back broken"), false;
      continue;
    }
    if (any) {
      ring_->give_back(best);
      ++skipped_;
    }
    best = filled;
    any = true;
    if (options_.every_frame) break;
  }
  if (any) {
    const bool delivered = deliver(best, frame);
    if (const int error = ring_->give_back(best); error < 0) fail(error);
    if (delivered) return true;
  } else {
    calls_.sleep(IDLE_s);
  }
  return watch_for_starving(), false;
}

bool CaptureCore::usable(const Filled& filled) {
  const bool broken = filled.flags & V4L2_BUF_FLAG_ERROR;
  if (broken || filled.bytes_used == 0) {
    ++bad_in_row_;
    statistics_.bad();
    tell(Event::BAD_BUFFER, fmt::format("{}, number {}, {} bytes", broken ? "marked as broken" : "empty",
                                        filled.sequence, filled.bytes_used));
    return false;
  }
  bad_in_row_ = 0;
  const std::uint32_t before = sequence_.last();
  const auto verdict = sequence_.check(filled.sequence, is_single_field(granted_.field));
  if (verdict.missing > 0)
    tell(Event::SEQUENCE_GAP, fmt::format("{} frames are missing before number {}", verdict.missing, filled.sequence));
  if (verdict.restarted)
    tell(Event::SEQUENCE_RESTART, fmt::format("the count went from {} to {}", before, filled.sequence));
  missing_ += verdict.missing;
  count_ += 1 + verdict.missing;
  return true;
}

bool CaptureCore::deliver(const Filled& filled, Frame& frame) {
  const double dequeued = calls_.now_s();
  frame = Frame{};
  std::string problem;
  try {
    problem = decoder_->decode(filled.bytes, filled.field, with_colour_, frame.grey, frame.colour);
    if (problem.empty() && !crop_known_) {
      crop_ = crop_of(options_.crop, frame.grey, options_.device);
      decoder_->crop_to(crop_);
      crop_known_ = true;
      if (crop_.area() > 0) decoder_->decode(filled.bytes, filled.field, with_colour_, frame.grey, frame.colour);
    }
  } catch (const std::exception& e) {  // a crop outside a picture that has changed, or not found yet
    problem = e.what();
  }
  if (!problem.empty()) {
    statistics_.bad();
    tell(Event::BAD_PICTURE, fmt::format("number {} {}", filled.sequence, problem));
    return false;
  }
  const double decoded = calls_.now_s();
  auto stamp = clock_.stamp(filled.time_s, dequeued, filled.flags);
  const bool of_start = (filled.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  const double middle = stamp.time_s + (of_start ? 0.5 : -0.5) * granted_.exposure_s;
  if (!any_frame_) {
    origin_s_ = middle;
    size_ = frame.grey.size();
  }
  if (stamp.jumped) tell(Event::TIME_JUMP, stamp.jump);
  CaptureStamp& capture = frame.capture.emplace();
  capture.device_s = filled.time_s;
  capture.dequeued_s = dequeued - origin_s_;
  capture.decoded_s = decoded - origin_s_;
  capture.start_of_exposure = of_start;
  capture.clock_is_monotonic = stamp.origin == StampOrigin::MONOTONIC;
  capture.device_sequence = filled.sequence;
  capture.flags = filled.flags;
  capture.missing = missing_;
  capture.skipped = skipped_;
  frame.time_s = middle - origin_s_;
  frame.sequence = count_ - 1;
  statistics_.frame(frame.time_s, capture.dequeued_s, capture.decoded_s, 1 + missing_ + skipped_, missing_, skipped_);
  missing_ = skipped_ = 0;
  any_frame_ = true;
  recovered();
  if (frame.grey.size() != size_) {
    frame.status = FrameStatus::UNREADABLE;
    frame.note = fmt::format("{}: the picture is {} x {} px, the first one was {} x {}", options_.device,
                             frame.grey.cols, frame.grey.rows, size_.width, size_.height);
    frame.grey.release();
    frame.colour.release();
    return true;
  }
  judge_life(frame.grey, frame);
  return true;
}

void CaptureCore::judge_life(const cv::Mat& grey, Frame& frame) {
  const double same_for = options_.frozen_s > 0 ? freeze_.same_for(grey, frame.time_s) : 0;
  if (same_for >= options_.frozen_s && options_.frozen_s > 0 && !frozen_) {
    frozen_ = true;
    tell(Event::FROZEN_PICTURE, fmt::format("the picture has been the same for {:.2f} s", same_for));
    set_fault(freeze_fault_, "the picture is frozen");
  } else if (same_for == 0 && frozen_) {
    frozen_ = false;
    tell(Event::PICTURE_MOVES, "");
    set_fault(freeze_fault_, "");
  }
  if (const std::string why = fault(); !why.empty()) {
    frame.status = FrameStatus::NOT_LIVE;
    frame.note = options_.device + ": " + why;
  }
}

std::string CaptureCore::fault() const {
  const std::lock_guard lock(facts_);
  return !stopped_.empty() ? stopped_ : !signal_fault_.empty() ? signal_fault_ : freeze_fault_;
}

Granted CaptureCore::granted() const {
  const std::lock_guard lock(facts_);
  return granted_;
}

void CaptureCore::set_fault(std::string& which, std::string text) {
  const std::lock_guard lock(facts_);
  which = std::move(text);
}

void CaptureCore::tell(Event event, std::string detail) { log_.add(now_s(), event, std::move(detail)); }

CaptureReport CaptureCore::report() const {
  CaptureReport report;
  statistics_.write(report);
  const Granted granted = this->granted();
  report.device = granted.device;
  report.card = granted.card;
  report.driver = granted.driver;
  report.input = granted.input;
  report.granted = granted.format();
  report.granted_rate_hz = granted.rate_hz;
  report.timings = granted.timings ? granted.timings->text() : "";
  report.controls = granted.controls;
  report.event_counts = log_.counts();
  for (const auto& record : log_.records())
    report.events.push_back({record.time_s, name_of(record.event), record.detail});
  return report;
}

}  // namespace heartservo::tracking::v4l2
