// How CaptureCore notices that frames stop, and what it does about it.
#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "tracking/frames/v4l2/capture_core.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking::v4l2 {

namespace {

constexpr double RETRY_s = 0.1;        // between attempts to open
constexpr double IDLE_s = 0.02;        // of a step that only waits
constexpr int RESTARTS = 2;            // without a good frame between them; then the device is opened anew
constexpr double STARVED_PERIODS = 5;  // at low rates

bool is_gone(int error) { return error == -ENODEV || error == -ENXIO || error == -ENOENT; }

}  // namespace

void CaptureCore::down(const std::string& why) {
  if (down_since_s_ < 0) down_since_s_ = calls_.now_s();
  statistics_.interrupted();
  set_fault(stopped_, why);
}

void CaptureCore::recovered() {
  last_good_s_ = calls_.now_s();
  starved_ = false;
  restarts_ = 0;
  if (down_since_s_ < 0) return;
  tell(Event::RECOVERED, fmt::format("{:.2f} s after frames stopped", last_good_s_ - down_since_s_));
  down_since_s_ = -1;
  set_fault(stopped_, "");
}

// An error of a call on the device.
void CaptureCore::fail(int error) {
  if (is_gone(error)) {
    disconnect();
    gone_untold_ = true;  // the node of an unplugged device disappears a moment later
    down("the device is gone");
    return come_back_later(RETRY_s);
  }
  tell(Event::STREAM_ERROR, std::strerror(-error));
  restart(std::strerror(-error));
}

void CaptureCore::restart(const std::string& why) {
  down(why);
  if (++restarts_ > RESTARTS) return come_back_later(0);
  const int result = ring_->start(options_.buffers);
  if (is_gone(result)) return fail(result);
  if (result < 0) return come_back_later(RETRY_s);
  tell(Event::RESTARTED, why);
  clock_.restart();
  sequence_.restart();
  bad_in_row_ = 0;
}

void CaptureCore::come_back_later(double seconds) {
  disconnect();
  next_try_s_ = calls_.now_s() + seconds;
}

void CaptureCore::reopen() {
  const double now = calls_.now_s();
  if (now < next_try_s_) return calls_.sleep(std::clamp(next_try_s_ - now, 1e-4, IDLE_s));
  if (gone_untold_) {
    gone_untold_ = false;
    const bool kept = calls_.exists(options_.device);
    tell(kept ? Event::DISCONNECTED : Event::UNPLUGGED,
         kept ? "the device is gone, its node is there" : "the node is gone");
    set_fault(stopped_, kept ? "the device is disconnected" : "the device is unplugged");
  }
  try {
    connect();
    tell(Event::REOPENED, granted_.format());
    restarts_ = 0;
    last_good_s_ = calls_.now_s();  // the new stream has its own time to begin
    starved_ = false;
    down(fault().empty() ? "the stream begins" : fault());
  } catch (const std::exception& e) {
    set_fault(last_open_error_, e.what());
    next_try_s_ = now + RETRY_s;
    const double since = down_since_s_ < 0 ? now : down_since_s_;
    if (now - since > options_.give_up_s) {
      gave_up_ = true;
      tell(Event::GAVE_UP, fmt::format("away for {:.1f} s: {}", now - since, e.what()));
      set_fault(stopped_, fmt::format("did not come back within {} s: {}", options_.give_up_s, e.what()));
    }
  }
}

void CaptureCore::watch_for_starving() {
  const double now = calls_.now_s();
  const double period = granted_.rate_hz > 0 ? 1 / granted_.rate_hz : 0;
  const double limit = std::max(options_.no_frame_s, STARVED_PERIODS * period);
  if (fd_ < 0 || now - last_good_s_ < limit * (1 + restarts_)) return;
  if (down_since_s_ >= 0 && now - down_since_s_ > options_.give_up_s) {
    gave_up_ = true;
    tell(Event::GAVE_UP, fmt::format("no good frame for {:.1f} s", now - down_since_s_));
    return set_fault(stopped_, fmt::format("no good frame for {} s", options_.give_up_s));
  }
  if (!starved_)
    tell(Event::STARVED, fmt::format("no good frame for {:.2f} s; poll says that there {}", now - last_good_s_,
                                     polled_readable_ ? "is one" : "is none"));
  starved_ = true;
  restart("no good frame");
}

void CaptureCore::take_device_events() {
  v4l2_event event{};
  bool changed = false;
  for (int i = 0; i < 16 && calls_.ioctl(fd_, VIDIOC_DQEVENT, &event) == 0; ++i)
    changed |= event.type == V4L2_EVENT_SOURCE_CHANGE;
  if (changed) check_signal();
}

void CaptureCore::check_signal() {
  next_signal_check_s_ = calls_.now_s() + options_.signal_check_s;
  const Signal signal = signal_of(calls_, fd_);
  if (signal.fault) {
    changed_.reset();
    const std::string now = name_of(*signal.fault);
    if (signal_fault_ == now) return;
    tell(*signal.fault, granted_.input.empty() ? "" : "input " + granted_.input);
    return set_fault(signal_fault_, now);
  }
  if (!signal_fault_.empty()) {
    tell(Event::SIGNAL_BACK, signal.timings ? signal.timings->text() : "");
    set_fault(signal_fault_, "");
  }
  const bool differs = signal.timings && !(granted_.timings && granted_.timings->same_as(*signal.timings));
  if (!differs) return changed_.reset();
  if (!changed_ || !changed_->same_as(*signal.timings)) {  // a signal that settles changes more than once
    changed_ = signal.timings;
    return;
  }
  tell(Event::RESOLUTION_CHANGED,
       fmt::format("from {} to {}", granted_.timings ? granted_.timings->text() : "nothing", signal.timings->text()));
  down("the signal changed");
  come_back_later(0);
}

}  // namespace heartservo::tracking::v4l2
