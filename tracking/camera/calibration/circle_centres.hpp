#pragma once
#include <opencv2/core/mat.hpp>
#include <vector>

#include "tracking/camera/calibration/board.hpp"

namespace heartservo::tracking {

/// Centres (px) of round, dark spots of the picture, roughly; candidates for a grid.
std::vector<cv::Point2f> dark_spots(const cv::Mat& grey);

/// A dark disc on light paper.
struct DiscMeasurement {
  Eigen::Vector2d centre;  ///< centre of gravity of its darkness, px
  double area_px2 = 0;
};

/// The disc at `near`, others being `pitch_px` away: darkness is 1 - grey / paper, where paper is a plane fitted to the
/// ring around the disc, so that light which falls off across the disc does not move its centre. False when there is
/// no such disc.
bool measure_disc(const cv::Mat& grey, const Eigen::Vector2d& near, double pitch_px, DiscMeasurement& disc);

}  // namespace heartservo::tracking
