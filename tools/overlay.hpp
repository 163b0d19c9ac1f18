#pragma once
// What is drawn over a frame for people to look at, and the keys that say what it means.
#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "tools/report/report.hpp"
#include "tracking/planar/track.hpp"

namespace heartservo::tracking {
struct Frame;
}

namespace heartservo::tools {

/// The frame as a colour picture to draw on.
cv::Mat canvas_of(const tracking::Frame& frame);

/// The colour (BGR) of series i: seven that the colour-blind can tell apart, the plots' own, then again. The second
/// seven are thin (in plots they are dashed, which here means LOST).
cv::Scalar series_colour(std::size_t i);
int series_width(std::size_t i);

/// The region, coloured by its state (blue OK, orange uncertain, red lost and dashed).
void draw_region(cv::Mat& bgr, const tracking::Track& track);
PictureKey region_key(const tracking::Track& track);

/// The region in a colour and width (px) of its own; dashed when LOST.
void draw_region(cv::Mat& bgr, const tracking::Track& track, const cv::Scalar& colour, int width);

/// Tints the pixels that `mask` (CV_8UC1, as large as the picture, or empty) marks as left out by a tracker; false
/// where there are none.
bool tint_left_out(cv::Mat& bgr, const cv::Mat& mask);
PictureKey left_out_key();

/// Goal (ring) and tip (cross), px; a NaN is not drawn.
void draw_goal_and_tip(cv::Mat& bgr, const Eigen::Vector2d& goal_px, const Eigen::Vector2d& tip_px);
PictureKey goal_and_tip_key();

/// A point known to be there (cross with a dark rim), px; a NaN is not drawn: false.
bool draw_point(cv::Mat& bgr, const Eigen::Vector2d& px);
PictureKey point_key(const std::string& label);

}  // namespace heartservo::tools
