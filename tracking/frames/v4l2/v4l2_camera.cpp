#include "tracking/frames/v4l2/v4l2_camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "tracking/frames/frame.hpp"
#include "tracking/frames/v4l2/capture_core.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking::v4l2 {

namespace {

constexpr double FIRST_PICTURE_s = 5;  // a camera may need a second for its light
constexpr double PATIENCE_s = 0.1;     // of next(): at least this, or
constexpr double PATIENCE_PERIODS = 2.5;
constexpr double QUEUE_s = 2;    // of frames that wait to be asked for
constexpr int RATE_FRAMES = 10;  // that the rate is measured on where the device does not say it

std::string wanted_text(const CameraOptions& o) {
  return fmt::format("{}{}{}{}", o.format.empty() ? "any format" : o.format,
                     o.size.area() > 0 ? fmt::format(" {}x{}", o.size.width, o.size.height) : "",
                     o.rate_hz > 0 ? fmt::format(" at {:.2f} Hz", o.rate_hz) : "",
                     o.input.empty() ? "" : fmt::format(", input {}", o.input));
}

class Camera final : public V4l2Camera {
 public:
  Camera(const CameraOptions& options, bool with_colour, SystemCalls& calls)
      : options_(options), core_(calls, options, with_colour) {
    core_.open();
    wait_for_first();
    const double rate = frame_rate_hz();
    most_queued_ = options.every_frame ? std::max<std::size_t>(60, static_cast<std::size_t>(QUEUE_s * rate)) : 1;
    patience_s_ = std::max(PATIENCE_s, PATIENCE_PERIODS / rate);
    thread_ = std::thread([this] { run(); });
  }

  ~Camera() override {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }

  bool wait_for(Frame& frame, double seconds) override {
    std::unique_lock lock(mutex_);
    const auto there = [this] { return !queue_.empty() || ended_; };
    for (;;) {
      if (!arrived_.wait_for(lock, std::chrono::duration<double>(seconds), there) || queue_.empty()) return false;
      frame = std::move(queue_.front());
      queue_.pop_front();
      if (frame.time_s > last_s_) break;  // else older than a frame that was made up for it
    }
    frame.capture->skipped += replaced_;
    replaced_ = 0;
    last_s_ = frame.time_s;
    last_sequence_ = frame.sequence;
    return true;
  }

  bool next(Frame& frame) override {
    if (wait_for(frame, patience_s_)) return true;
    if (ended()) return false;
    frame = Frame{};
    frame.status = FrameStatus::UNREADABLE;
    // every frame: none may be left out because one was made up, so that time has to stand still
    last_s_ = options_.every_frame ? last_s_ + 1e-9 : std::max(last_s_ + 1e-6, now_s() - usual_age_s());
    frame.time_s = last_s_;
    frame.sequence = last_sequence_;
    const std::string why = core_.fault();
    frame.note = fmt::format("{}: no frame: {}", options_.device, why.empty() ? "none came in time" : why);
    return true;
  }

  cv::Size size() const override { return core_.size(); }
  double frame_rate_hz() const override {
    const double rate = core_.granted().rate_hz;
    return rate > 0 ? rate : measured_hz_;
  }
  std::optional<std::size_t> frame_count() const override { return std::nullopt; }
  std::string description() const override { return options_.device; }
  double now_s() const override { return core_.now_s(); }
  bool ended() const override { return ended_; }
  std::string failure() const override { return ended_ ? options_.device + ": " + core_.fault() : ""; }

  CaptureReport report() const override {
    CaptureReport report = core_.report();
    report.wanted = wanted_text(options_);
    report.stamps = stamps_;
    report.crop = options_.crop.empty() ? "" : fmt::format("{} to {}x{}", options_.crop, size().width, size().height);
    const std::lock_guard lock(mutex_);
    report.queue_dropped = options_.every_frame ? dropped_ : 0;
    report.skipped += options_.every_frame ? 0 : dropped_;
    return report;
  }

 private:
  void wait_for_first() {
    const double begin = core_.now_s();
    Frame frame;
    std::string last;
    while (!core_.step(frame) || frame.status != FrameStatus::OK) {
      if (core_.now_s() - begin < FIRST_PICTURE_s) continue;
      const auto events = core_.events().records();
      std::string why = core_.fault();
      if (!events.empty()) why = fmt::format("{}: {}", name_of(events.back().event), events.back().detail);
      throw DeviceError(fmt::format("{}: no live picture within {} s ({}); granted was {}", options_.device,
                                    FIRST_PICTURE_s, why.empty() ? "nothing came" : why, core_.granted().format()));
    }
    stamps_ = fmt::format("{}, {}", frame.capture->clock_is_monotonic ? "monotonic clock" : "a clock of its own",
                          frame.capture->start_of_exposure ? "start of exposure" : "end of frame");
    queue_.push_back(frame);
    if (core_.granted().rate_hz <= 0) measure_rate();
  }

  // The frames that it takes are the first of those that next() gives, or older than what a loop wants.
  void measure_rate() {
    const double begin = core_.now_s();
    Frame frame;
    for (int i = 0; i < RATE_FRAMES && core_.now_s() - begin < FIRST_PICTURE_s;) {
      if (!core_.step(frame)) continue;
      ++i;
      if (!options_.every_frame) queue_.clear();
      queue_.push_back(frame);
    }
    const double rate = core_.report().measured_rate_hz;
    measured_hz_ = rate > 5 ? std::round(rate) : rate;
    if (!(measured_hz_ > 0))
      throw DeviceError(
          fmt::format("{}: too few frames came within {} s to tell their rate", options_.device, FIRST_PICTURE_s));
  }

  void run() {
    Frame frame;
    while (!stop_ && !core_.gave_up())
      if (core_.step(frame)) publish(std::move(frame));
    const std::lock_guard lock(mutex_);
    ended_ = true;
    arrived_.notify_all();
  }

  void publish(Frame&& frame) {
    const std::lock_guard lock(mutex_);
    if (queue_.size() >= most_queued_) {
      queue_.pop_front();
      ++dropped_;
      ++replaced_;
    }
    queue_.push_back(std::move(frame));
    arrived_.notify_one();
  }

  double usual_age_s() const { return 1e-3 * core_.report().transfer_ms; }

  CameraOptions options_;
  CaptureCore core_;
  std::string stamps_;
  std::size_t most_queued_ = 1;
  double patience_s_ = PATIENCE_s, measured_hz_ = 0;
  double last_s_ = -1e300;  // of the consumer
  std::uint64_t last_sequence_ = 0;
  mutable std::mutex mutex_;  // guards the queue and what is counted beside it
  std::condition_variable arrived_;
  std::deque<Frame> queue_;
  std::uint64_t dropped_ = 0;
  std::uint32_t replaced_ = 0;
  std::atomic<bool> stop_ = false, ended_ = false;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<V4l2Camera> open_v4l2_camera(const CameraOptions& options, bool with_colour, SystemCalls& calls) {
  return std::make_unique<Camera>(options, with_colour, calls);
}

}  // namespace heartservo::tracking::v4l2
