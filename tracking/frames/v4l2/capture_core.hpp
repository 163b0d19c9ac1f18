#pragma once
// A camera's life, step by step: waits for a frame, judges it, notices every fault and brings the device back. One
// thread calls step(); what it says about itself may be read from another.
#include <mutex>
#include <optional>
#include <string>

#include "tracking/frames/frame.hpp"
#include "tracking/frames/live_source.hpp"
#include "tracking/frames/v4l2/buffer_ring.hpp"
#include "tracking/frames/v4l2/camera_options.hpp"
#include "tracking/frames/v4l2/capture_statistics.hpp"
#include "tracking/frames/v4l2/events.hpp"
#include "tracking/frames/v4l2/picture_decoder.hpp"
#include "tracking/frames/v4l2/set_up.hpp"
#include "tracking/frames/v4l2/stamp_clock.hpp"
#include "tracking/frames/v4l2/system_calls.hpp"
#include "tracking/frames/v4l2/watches.hpp"

namespace heartservo::tracking::v4l2 {

class CaptureCore {
 public:
  CaptureCore(SystemCalls& calls, const CameraOptions& options, bool with_colour);
  ~CaptureCore();
  CaptureCore(const CaptureCore&) = delete;
  CaptureCore& operator=(const CaptureCore&) = delete;

  /// Opens, sets up and starts the stream. Throws DeviceError (no such device, busy, no permission, nothing that can be
  /// decoded), ConfigError (an input or control that it does not have).
  void open();

  /// Waits for a frame, 50 ms at most, or does what brings the device back. True with a frame: status OK; NOT_LIVE
  /// (frozen, no signal); or UNREADABLE, of another size than the first. Throws nothing.
  bool step(Frame& frame);

  bool gave_up() const { return gave_up_; }
  /// What keeps frames from coming, or from being live; "" while all is well.
  std::string fault() const;
  cv::Size size() const { return size_; }  ///< of the first picture; empty before it
  Granted granted() const;
  CaptureReport report() const;
  const EventLog& events() const { return log_; }
  double now_s() const { return calls_.now_s() - origin_s_; }  ///< on the clock of Frame::time_s

 private:
  void connect();  // open + set up + start; throws
  void disconnect();
  void fail(int error);
  void restart(const std::string& why);
  void reopen();
  void come_back_later(double seconds);
  void watch_for_starving();
  void check_signal();
  void take_device_events();
  bool usable(const Filled& filled);
  bool deliver(const Filled& filled, Frame& frame);
  void judge_life(const cv::Mat& grey, Frame& frame);
  void recovered();
  void down(const std::string& why);
  void tell(Event event, std::string detail);
  void set_fault(std::string& which, std::string text);

  SystemCalls& calls_;
  CameraOptions options_;
  bool with_colour_;
  int fd_ = -1;
  std::optional<BufferRing> ring_;
  std::optional<PictureDecoder> decoder_;
  EventLog log_;
  StampClock clock_;
  SequenceWatch sequence_;
  FreezeWatch freeze_;
  CaptureStatistics statistics_;
  double origin_s_ = 0;  // our clock at time_s = 0
  bool any_frame_ = false, gave_up_ = false, frozen_ = false, starved_ = false, polled_readable_ = false;
  bool gone_untold_ = false;  // the device is gone; whether its node is too shows in a moment
  double last_good_s_ = 0, down_since_s_ = -1, next_signal_check_s_ = 0, next_try_s_ = 0;
  int bad_in_row_ = 0, restarts_ = 0;
  std::uint64_t count_ = 0;                  // frames since the start, missing ones too
  std::uint32_t missing_ = 0, skipped_ = 0;  // since the last one delivered
  std::optional<Timings> changed_;
  cv::Rect crop_;
  bool crop_known_ = false;
  cv::Size size_;
  mutable std::mutex facts_;  // guards what follows
  Granted granted_;
  std::string stopped_, signal_fault_, freeze_fault_, last_open_error_;
};

}  // namespace heartservo::tracking::v4l2
