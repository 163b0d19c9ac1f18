#include "tools/window/live_window.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <future>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "tools/window/screen.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kLook(10);      // how often keys are looked at
constexpr milliseconds kDraw(30);      // at most this often
constexpr double kTrail_s = 2;         // of the tip
constexpr double kLongestWait_s = 10;  // for a frame's time: time stamps may jump

}  // namespace

struct LiveWindow::Parts {
  Parts(cv::Size picture, bool paced) : layout(picture), pace(paced) {}

  const WindowLayout layout;
  const bool pace;
  std::mutex mutex;  // guards what follows
  std::condition_variable changed;
  WindowView latest;
  WindowState state;
  std::deque<std::pair<double, Eigen::Vector2d>> trail;
  bool fresh = false, ends = false;
  // of the loop's thread
  bool timed = false;
  double first_time_s = 0;
  Clock::time_point first_shown;
  // of both
  std::promise<void> opened;
  std::atomic<bool> finished = false;
  std::thread thread;

  void leave() {
    {
      const std::lock_guard lock(mutex);
      ends = true;
    }
    changed.notify_all();
    while (!finished && !Screen::lost()) std::this_thread::sleep_for(kLook);
    if (finished)
      thread.join();
    else
      thread.detach();
  }

  // Keys and clicks into the state; true if there were any. The lock is never held in a call of the screen: it may not
  // come back.
  bool listen(Screen& screen, const cv::Mat& grey) {
    bool any = false;
    for (; const auto key = screen.key(); any = true) {
      const std::lock_guard lock(mutex);
      state.key(*key);
    }
    for (; const auto at = screen.click(); any = true) {
      const std::lock_guard lock(mutex);
      state.click(layout.to_picture({static_cast<double>(at->x), static_cast<double>(at->y)}), grey);
    }
    if (any) changed.notify_all();
    return any;
  }

  // Of a frame without a picture the one before stays.
  void take_latest(WindowView& view) {
    const cv::Mat before = view.picture;
    std::swap(view, latest);
    if (view.picture.empty()) view.picture = before.clone();
  }

  void run(Screen& screen) {
    WindowView view;
    WindowMarks marks;
    cv::Mat grey;
    bool stale = false;
    auto drawn_at = Clock::now() - kDraw;
    for (;;) {
      {
        std::unique_lock lock(mutex);
        changed.wait_for(lock, kLook, [this] { return ends; });
        if (ends) return;
      }
      stale |= listen(screen, grey);
      if (Clock::now() - drawn_at < kDraw) continue;
      {
        const std::lock_guard lock(mutex);
        if (fresh) take_latest(view);
        stale |= fresh;
        fresh = false;
        if (!stale) continue;
        marks = {{}, state.clicks(), state.keys(), state.paused()};
        for (const auto& [time_s, px] : trail) marks.trail.push_back(px);
      }
      drawn_at = Clock::now();
      stale = false;
      if (view.picture.channels() == 1)
        grey = view.picture;
      else if (!view.picture.empty())
        cv::cvtColor(view.picture, grey, cv::COLOR_BGR2GRAY);
      screen.show(drawn(layout, view, marks));
    }
  }
};

LiveWindow::LiveWindow(const std::string& title, cv::Size picture, bool pace)
    : parts_(std::make_shared<Parts>(picture, pace)) {
  auto opened = parts_->opened.get_future();
  parts_->thread = std::thread([parts = parts_, title] {
    try {
      Screen screen(title, parts->layout.canvas());
      parts->opened.set_value();
      parts->run(screen);
    } catch (...) {
      parts->opened.set_exception(std::current_exception());
    }
    parts->finished = true;
  });
  while (opened.wait_for(kLook) != std::future_status::ready)
    if (Screen::lost()) break;
  try {
    if (Screen::lost()) throw DeviceError("--show: the display went away");
    opened.get();
  } catch (...) {
    parts_->leave();
    throw;
  }
}

LiveWindow::~LiveWindow() { parts_->leave(); }

void LiveWindow::show(const WindowView& view) {
  Parts& p = *parts_;
  const std::lock_guard lock(p.mutex);
  cv::Mat kept = std::move(p.latest.picture);
  p.latest = view;
  if (!view.picture.empty()) {
    view.picture.copyTo(kept);
    p.latest.picture = std::move(kept);
  }
  p.trail.emplace_back(view.time_s, view.tip_px);
  while (!p.trail.empty() && p.trail.front().first < view.time_s - kTrail_s) p.trail.pop_front();
  p.fresh = true;
}

WindowState::Asked LiveWindow::attend(const Stop& stop) {
  Parts& p = *parts_;
  std::unique_lock lock(p.mutex);
  const double time_s = p.trail.empty() ? 0 : p.trail.back().first;
  const auto shown_at = [&] { return p.first_shown + std::chrono::duration<double>(time_s - p.first_time_s); };
  for (bool waited = false;;) {
    if (Screen::lost()) p.state.close();
    WindowState::Asked asked = p.state.take();
    if (asked.quit || asked.relearn || asked.region || stop()) return asked;
    if (p.state.paused()) {
      waited = true;
    } else {
      if (waited || !p.timed || shown_at() > Clock::now() + std::chrono::duration<double>(kLongestWait_s)) {
        p.first_time_s = time_s;
        p.first_shown = Clock::now();
        p.timed = true;
        waited = false;
      }
      if (!p.pace || Clock::now() >= shown_at()) return {};
    }
    const auto until = p.state.paused() ? Clock::now() + milliseconds(20)
                                        : std::min(Clock::now() + milliseconds(20),
                                                   std::chrono::time_point_cast<Clock::duration>(shown_at()));
    p.changed.wait_until(lock, until);
  }
}

std::optional<tracking::Quad> LiveWindow::select(const cv::Mat& picture, const Stop& stop) {
  WindowView view;
  view.picture = picture;
  {
    const std::lock_guard lock(parts_->mutex);
    parts_->state.ask_for_region();
  }
  show(view);
  for (;;) {
    const WindowState::Asked asked = attend(stop);
    if (asked.quit || stop()) return {};
    if (asked.region) {
      const std::lock_guard lock(parts_->mutex);
      parts_->trail.clear();
      return asked.region;
    }
  }
}

}  // namespace heartservo::tools
