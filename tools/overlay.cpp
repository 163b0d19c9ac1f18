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

// Okabe and Ito's palette, told apart by the colour-blind; BGR.
const cv::Scalar kBlue(233, 180, 86), kOrange(0, 159, 230), kRed(0, 94, 213), kGreen(115, 158, 0),
    kYellow(66, 228, 240), kWhite(255, 255, 255), kBlack(0, 0, 0);

cv::Scalar colour_of(tracking::TrackState state) {
  return state == tracking::TrackState::OK ? kBlue : state == tracking::TrackState::UNCERTAIN ? kOrange : kRed;
}

void draw_cross(cv::Mat& bgr, const Eigen::Vector2d& at, double arm_px, const cv::Scalar& colour, int width) {
  for (const Eigen::Vector2d& arm : {Eigen::Vector2d(arm_px, 0), Eigen::Vector2d(0, arm_px)})
    cv::line(bgr, fixed(at - arm), fixed(at + arm), colour, width, cv::LINE_AA, kShift);
}

}  // namespace

cv::Mat canvas_of(const tracking::Frame& frame) {
  cv::Mat canvas;
  if (!frame.colour.empty())
    canvas = frame.colour.clone();
  else if (!frame.grey.empty())
    cv::cvtColor(frame.grey, canvas, cv::COLOR_GRAY2BGR);
  return canvas;
}

cv::Scalar series_colour(std::size_t i) {
  static const cv::Scalar colours[] = {{178, 114, 0}, {0, 94, 213},   {115, 158, 0},  {167, 121, 204},
                                       {0, 159, 230}, {233, 180, 86}, {107, 107, 107}};
  return colours[i % std::size(colours)];
}

int series_width(std::size_t i) { return i % 14 < 7 ? 2 : 1; }

void draw_region(cv::Mat& bgr, const tracking::Track& track) { draw_region(bgr, track, colour_of(track.state), 2); }

PictureKey region_key(const tracking::Track& track) {
  const bool lost = track.state == tracking::TrackState::LOST;
  const char* label = track.state == tracking::TrackState::OK ? "region, followed"
                      : lost                                  ? "region where it was last believed: LOST"
                                                              : "region, uncertain";
  return {label, colour_of(track.state), lost ? PictureKey::Mark::DASHES : PictureKey::Mark::LINE};
}

void draw_region(cv::Mat& bgr, const tracking::Track& track, const cv::Scalar& colour, int width) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d from = track.corners[i], to = track.corners[(i + 1) % 4];
    if (!drawable(from) || !drawable(to)) continue;
    const int pieces = track.state == tracking::TrackState::LOST ? 9 : 1;
    for (int k = 0; k < pieces; k += 2)
      cv::line(bgr, fixed(from + (to - from) * k / pieces), fixed(from + (to - from) * (k + 1) / pieces), colour, width,
               cv::LINE_AA, kShift);
  }
}

bool tint_left_out(cv::Mat& bgr, const cv::Mat& mask) {
  if (mask.empty() || cv::countNonZero(mask) == 0) return false;
  constexpr double kShare = 0.55;
  cv::Mat tinted;
  cv::addWeighted(bgr, 1 - kShare, cv::Mat(bgr.size(), bgr.type(), kYellow), kShare, 0, tinted);
  tinted.copyTo(bgr, mask);
  return true;
}

PictureKey left_out_key() { return {"left out: glare, tool, strange pixels", kYellow, PictureKey::Mark::AREA}; }

void draw_goal_and_tip(cv::Mat& bgr, const Eigen::Vector2d& goal_px, const Eigen::Vector2d& tip_px) {
  if (drawable(goal_px)) cv::circle(bgr, fixed(goal_px), 7 << kShift, kGreen, 2, cv::LINE_AA, kShift);
  if (drawable(tip_px)) draw_cross(bgr, tip_px, 5, kWhite, 1);
}

PictureKey goal_and_tip_key() { return {"goal (ring) and tip (cross)", kGreen}; }

bool draw_point(cv::Mat& bgr, const Eigen::Vector2d& px) {
  if (!drawable(px)) return false;
  draw_cross(bgr, px, 5, kBlack, 4);
  draw_cross(bgr, px, 4, kWhite, 2);
  return true;
}

PictureKey point_key(const std::string& label) { return {label, kWhite}; }

}  // namespace heartservo::tools
