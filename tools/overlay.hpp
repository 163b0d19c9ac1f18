#pragma once
#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "tracking/planar/track.hpp"

namespace heartservo::tracking {
struct Frame;
}

namespace heartservo::tools {

/// The frame as a colour picture to draw on.
cv::Mat canvas_of(const tracking::Frame& frame);

/// The region, coloured by its state (blue OK, orange uncertain, red lost and dashed).
void draw_region(cv::Mat& bgr, const tracking::Track& track);

/// Goal (ring) and tip (cross), px; a NaN is not drawn.
void draw_goal_and_tip(cv::Mat& bgr, const Eigen::Vector2d& goal_px, const Eigen::Vector2d& tip_px);

}  // namespace heartservo::tools
