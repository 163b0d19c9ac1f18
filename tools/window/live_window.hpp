#pragma once
// The live window (--show): the newest frame with what is known of it, keys and mouse. Drawing, X and their delays stay
// in a thread of their own; the loop only hands frames over, and waits where it is asked to pause.
#include <functional>
#include <memory>
#include <string>

#include "tools/window/window_state.hpp"
#include "tools/window/window_view.hpp"

namespace heartservo::tools {

class LiveWindow {
 public:
  /// `pace`: frames from disk or from a simulation are shown no faster than they were taken; not for a camera. Throws
  /// DeviceError where there is no display.
  LiveWindow(const std::string& title, cv::Size picture, bool pace);
  ~LiveWindow();
  LiveWindow(const LiveWindow&) = delete;
  LiveWindow& operator=(const LiveWindow&) = delete;

  /// Takes a copy and returns at once; what was not yet drawn is replaced.
  void show(const WindowView& view);

  using Stop = std::function<bool()>;
  /// Waits while the window is paused, and for the frame's time; returns at once what is asked for, and when `stop`.
  WindowState::Asked attend(const Stop& stop);

  /// Shows the picture and waits for four corners; empty when the window is closed, by q, or when `stop`.
  std::optional<tracking::Quad> select(const cv::Mat& picture, const Stop& stop);

 private:
  struct Parts;
  std::shared_ptr<Parts> parts_;  // the thread may outlive this
};

}  // namespace heartservo::tools
