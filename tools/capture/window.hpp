#pragma once
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace heartservo::tools {

/// The live picture in a window of ViSP's display (X11).
class Window {
 public:
  /// Throws ConfigError where there is no display.
  Window(const std::string& title, cv::Size size);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  struct Outline {
    std::vector<cv::Point2d> corners;  ///< px
    cv::Scalar bgr;
  };
  /// `grey` of the window's size; else nothing is drawn.
  void show(const cv::Mat& grey, const std::vector<Outline>& outlines);

 private:
  struct Display;
  std::unique_ptr<Display> display_;
};

}  // namespace heartservo::tools
