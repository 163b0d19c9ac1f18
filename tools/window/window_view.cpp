#include "tools/window/window_view.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "tools/overlay.hpp"

namespace heartservo::tools {

namespace {

constexpr int kSmallest_px = 640, kLargestWidth_px = 1280, kLargestHeight_px = 960;  // of the picture as shown
constexpr int kLine_px = 20, kMargin_px = 8;
constexpr double kFont = 0.45;
const cv::Scalar kBack(32, 32, 32), kText(235, 235, 235), kQuiet(170, 170, 170), kPaused(0, 159, 230),
    kTrail(66, 228, 240), kClick(255, 255, 255);

int enlarged_by(cv::Size picture) { return std::clamp(kSmallest_px / std::max(1, picture.width), 1, 4); }

int reduced_by(cv::Size picture) {
  return std::max((picture.width - 1) / kLargestWidth_px, (picture.height - 1) / kLargestHeight_px) + 1;
}

void write(cv::Mat& canvas, const WindowLayout& layout, std::size_t line, const std::string& text,
           const cv::Scalar& colour) {
  const cv::Rect place = layout.text();
  cv::putText(canvas, text, {kMargin_px, place.y + kMargin_px + static_cast<int>(line + 1) * kLine_px - 6},
              cv::FONT_HERSHEY_SIMPLEX, kFont, colour, 1, cv::LINE_AA);
}

bool drawable(const Eigen::Vector2d& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < 1e4; }

cv::Point fixed(const Eigen::Vector2d& p, int shift) {
  return {static_cast<int>(std::lround(p.x() * (1 << shift))), static_cast<int>(std::lround(p.y() * (1 << shift)))};
}

void draw_trail(cv::Mat& canvas, const WindowLayout& layout, const std::deque<Eigen::Vector2d>& trail) {
  constexpr int kShift = 4;
  for (std::size_t i = 1; i < trail.size(); ++i) {
    const Eigen::Vector2d a = layout.to_canvas(trail[i - 1]), b = layout.to_canvas(trail[i]);
    if (drawable(a) && drawable(b))
      cv::line(canvas, fixed(a, kShift), fixed(b, kShift), kTrail, 1, cv::LINE_AA, kShift);
  }
}

}  // namespace

WindowLayout::WindowLayout(cv::Size picture) : picture_(picture) {
  const int down = reduced_by(picture), up = down > 1 ? 1 : enlarged_by(picture);
  scale_ = static_cast<double>(up) / down;
  shown_ = {0, 0, picture.width * up / down, picture.height * up / down};
  canvas_ = {std::max(shown_.width, kSmallest_px),
             shown_.height + static_cast<int>(kWindowLines + 1) * kLine_px + 2 * kMargin_px};
}

Eigen::Vector2d WindowLayout::to_canvas(const Eigen::Vector2d& px) const {
  return (scale_ * (px.array() + 0.5) - 0.5).matrix();
}

Eigen::Vector2d WindowLayout::to_picture(const Eigen::Vector2d& canvas_px) const {
  return ((canvas_px.array() + 0.5) / scale_ - 0.5).matrix();
}

cv::Rect WindowLayout::text() const { return {0, shown_.height, canvas_.width, canvas_.height - shown_.height}; }

cv::Mat drawn(const WindowLayout& layout, const WindowView& view, const WindowMarks& marks) {
  cv::Mat canvas(layout.canvas(), CV_8UC3, kBack);
  if (view.picture.size() == layout.picture()) {
    cv::Mat bgr, place = canvas(layout.shown());
    if (view.picture.channels() == 1)
      cv::cvtColor(view.picture, bgr, cv::COLOR_GRAY2BGR);
    else
      bgr = view.picture;
    cv::resize(bgr, place, place.size(), 0, 0, place.cols < bgr.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
    draw_trail(place, layout, marks.trail);
    for (WindowView::Region region : view.regions) {
      for (auto& corner : region.track.corners) corner = layout.to_canvas(corner);
      if (region.series < 0)
        draw_region(place, region.track);
      else
        draw_region(place, region.track, series_colour(static_cast<std::size_t>(region.series)),
                    series_width(static_cast<std::size_t>(region.series)));
    }
    draw_goal_and_tip(place, layout.to_canvas(view.goal_px), layout.to_canvas(view.tip_px));
    for (std::size_t i = 0; i < marks.clicks.size(); ++i) {
      const cv::Point at = fixed(layout.to_canvas(marks.clicks[i]), 0);
      cv::drawMarker(place, at, kClick, cv::MARKER_CROSS, 13, 1);
      cv::putText(place, std::to_string(i + 1), at + cv::Point(6, -6), cv::FONT_HERSHEY_SIMPLEX, kFont, kClick, 1,
                  cv::LINE_AA);
    }
  }
  for (std::size_t i = 0; i < std::min(view.lines.size(), kWindowLines); ++i)
    write(canvas, layout, i, view.lines[i], kText);
  write(canvas, layout, kWindowLines, marks.keys, marks.paused ? kPaused : kQuiet);
  return canvas;
}

}  // namespace heartservo::tools
