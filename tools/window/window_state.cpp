#include "tools/window/window_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace heartservo::tools {

namespace {

constexpr int kSnap_px = 5;
constexpr double kSmallest_px2 = 64;  // a region below this is a slip of the hand

// The first corner stays the first; the others follow clockwise, in whatever order they were clicked.
tracking::Quad clockwise(const std::vector<Eigen::Vector2d>& clicks) {
  tracking::Quad quad{clicks[0], clicks[1], clicks[2], clicks[3]};
  const Eigen::Vector2d middle = tracking::centre(quad);
  const auto angle = [&](const Eigen::Vector2d& p) { return std::atan2(p.y() - middle.y(), p.x() - middle.x()); };
  const double first = angle(quad[0]);
  const auto turned = [&](const Eigen::Vector2d& p) { return std::fmod(angle(p) - first + 4 * M_PI, 2 * M_PI); };
  std::sort(quad.begin() + 1, quad.end(), [&](const auto& a, const auto& b) { return turned(a) < turned(b); });
  return quad;
}

}  // namespace

Eigen::Vector2d snapped(const cv::Mat& grey, const Eigen::Vector2d& px) {
  if (px.x() < kSnap_px || px.y() < kSnap_px || px.x() > grey.cols - 1 - kSnap_px || px.y() > grey.rows - 1 - kSnap_px)
    return px;
  std::vector<cv::Point2f> corner{{static_cast<float>(px.x()), static_cast<float>(px.y())}};
  cv::cornerSubPix(grey, corner, {kSnap_px, kSnap_px}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 0.01});
  const Eigen::Vector2d found(corner[0].x, corner[0].y);
  return found.allFinite() && (found - px).norm() <= kSnap_px ? found : px;
}

void WindowState::key(const std::string& name) {
  if (name == "q" || name == "Q") {
    asked_.quit = true;
  } else if (name == " " || name == "space") {
    if (goes_on_) return;
    paused_ = !paused_;
    clicks_.clear();
    complaint_.clear();
  } else if (name == "r" || name == "R") {
    asked_.relearn = clicks_.empty() && !goes_on_;
    clicks_.clear();
    complaint_.clear();
  }
}

void WindowState::click(const Eigen::Vector2d& px, const cv::Mat& grey) {
  if (!paused_ || grey.empty() || px.x() < 0 || px.y() < 0 || px.x() > grey.cols - 1 || px.y() > grey.rows - 1) return;
  complaint_.clear();
  clicks_.push_back(snapped(grey, px));
  if (clicks_.size() < 4) return;
  const tracking::Quad quad = clockwise(clicks_);
  clicks_.clear();
  if (!tracking::is_convex(quad) || tracking::area(quad) < kSmallest_px2) {
    complaint_ = "These four corners are no region. ";
    return;
  }
  asked_.region = quad;
  if (std::exchange(goes_on_, false)) paused_ = false;
}

std::string WindowState::keys() const {
  const std::string click = fmt::format("click 4 corners from top left ({} of 4)", clicks_.size());
  if (goes_on_) return complaint_ + "SELECT the region: " + click + "   q: end";
  if (paused_) return complaint_ + "PAUSED   space: go on   new region: " + click + "   q: end";
  return "space: pause, select a region   r: learn the region anew   q: end";
}

WindowState::Asked WindowState::take() { return std::exchange(asked_, {}); }

}  // namespace heartservo::tools
