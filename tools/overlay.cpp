#include "tools/overlay.hpp"

#include <opencv2/imgproc.hpp>

#include "tracking/frames/frame.hpp"

namespace heartservo::tools {

namespace {

constexpr int kShift = 4;  // OpenCV draws on sixteenths of a pixel
cv::Point fixed(const Eigen::Vector2d& p) {
  return {static_cast<int>(std::lround(p.x() * (1 << kShift))), static_cast<int>(std::lround(p.y() * (1 << kShift)))};
}
bool drawable(const Eigen::Vector2d& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() < 1e5; }

// Okabe-Ito, told apart by the colour-blind; BGR.
const cv::Scalar kBlue(233, 180, 86), kOrange(0, 159, 230), kRed(0, 94, 213), kGreen(115, 158, 0),
    kWhite(255, 255, 255);

}  // namespace

cv::Mat canvas_of(const tracking::Frame& frame) {
  cv::Mat canvas;
  if (!frame.colour.empty())
    canvas = frame.colour.clone();
  else if (!frame.grey.empty())
    cv::cvtColor(frame.grey, canvas, cv::COLOR_GRAY2BGR);
  return canvas;
}

void draw_region(cv::Mat& bgr, const tracking::Track& track) {
  const cv::Scalar colour = track.state == tracking::TrackState::OK          ? kBlue
                            : track.state == tracking::TrackState::UNCERTAIN ? kOrange
                                                                             : kRed;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d from = track.corners[i], to = track.corners[(i + 1) % 4];
    if (!drawable(from) || !drawable(to)) continue;
    const int pieces = track.state == tracking::TrackState::LOST ? 9 : 1;
    for (int k = 0; k < pieces; k += 2)
      cv::line(bgr, fixed(from + (to - from) * k / pieces), fixed(from + (to - from) * (k + 1) / pieces), colour, 2,
               cv::LINE_AA, kShift);
  }
}

void draw_goal_and_tip(cv::Mat& bgr, const Eigen::Vector2d& goal_px, const Eigen::Vector2d& tip_px) {
  if (drawable(goal_px)) cv::circle(bgr, fixed(goal_px), 7 << kShift, kGreen, 2, cv::LINE_AA, kShift);
  if (!drawable(tip_px)) return;
  for (const Eigen::Vector2d& arm : {Eigen::Vector2d(5, 0), Eigen::Vector2d(0, 5)})
    cv::line(bgr, fixed(tip_px - arm), fixed(tip_px + arm), kWhite, 1, cv::LINE_AA, kShift);
}

}  // namespace heartservo::tools
