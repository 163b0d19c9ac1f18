#pragma once
// A window of ViSP's display (X11). All of it belongs to the thread that made it, and that thread may be lost to it:
// when someone closes the window, or the display goes away, it never comes back from here.
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

namespace heartservo::tools {

class Screen {
 public:
  /// For pictures of `size`. Throws DeviceError where there is no display.
  Screen(const std::string& title, cv::Size size);
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// `bgr` of the window's size.
  void show(const cv::Mat& bgr);

  /// The next key that was pressed, as X names its character ("q", " "); none: empty.
  std::optional<std::string> key();
  /// Where the left button was pressed next, px of the picture; none: empty.
  std::optional<cv::Point> click();

  /// That has happened. For other threads.
  static bool lost();

 private:
  struct Display;
  std::unique_ptr<Display> display_;
};

}  // namespace heartservo::tools
