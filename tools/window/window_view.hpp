#pragma once
// What the live window shows of a frame, and how it is laid out: the picture, enlarged or reduced by a whole number,
// and below it lines of text.
#include <deque>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "tracking/planar/track.hpp"

namespace heartservo::tools {

/// Positions in px of the picture; NaN is not drawn.
struct WindowView {
  double time_s = 0;
  cv::Mat picture;  ///< CV_8UC1 or CV_8UC3 (BGR)
  struct Region {
    tracking::Track track;
    int series = -1;  ///< coloured as that series (overlay.hpp); -1: by its state
  };
  std::vector<Region> regions;
  Eigen::Vector2d goal_px = Eigen::Vector2d::Constant(NAN), tip_px = Eigen::Vector2d::Constant(NAN);
  std::vector<std::string> lines;  ///< below the picture; at most kWindowLines
};

constexpr std::size_t kWindowLines = 3;

class WindowLayout {
 public:
  explicit WindowLayout(cv::Size picture);

  cv::Size canvas() const { return canvas_; }
  cv::Size picture() const { return picture_; }
  Eigen::Vector2d to_canvas(const Eigen::Vector2d& px) const;
  Eigen::Vector2d to_picture(const Eigen::Vector2d& canvas_px) const;
  cv::Rect shown() const { return shown_; }  ///< where the picture lies on the canvas
  cv::Rect text() const;                     ///< below it

 private:
  cv::Size picture_, canvas_;
  cv::Rect shown_;
  double scale_ = 1;
};

/// Beside the view: where the tip was, corners clicked so far, what the keys do now.
struct WindowMarks {
  std::deque<Eigen::Vector2d> trail;
  std::vector<Eigen::Vector2d> clicks;
  std::string keys;
  bool paused = false;
};

/// The canvas (BGR) of the window.
cv::Mat drawn(const WindowLayout& layout, const WindowView& view, const WindowMarks& marks);

}  // namespace heartservo::tools
