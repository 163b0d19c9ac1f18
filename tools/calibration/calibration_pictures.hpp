#pragma once
// Drawings of a calibration for report.html (8 bit BGR).
#include <opencv2/core/mat.hpp>

#include "tools/calibration/calibration_summary.hpp"

namespace heartservo::tools {

/// Corners in the picture, one colour a view, with their errors enlarged; cells without corners are shaded.
/// `enlarged` comes out as how many times.
cv::Mat draw_picture_coverage(const CalibrationRun& run, std::size_t side, double& enlarged);

/// Errors of all corners, horizontally against vertically; `reach_px` comes out as the axes' end.
cv::Mat draw_errors(const CalibrationRun& run, std::size_t side, double& reach_px);

/// The slices of the working volume from near to far, with the number of board points in each cell.
cv::Mat draw_volume_coverage(const CalibrationRun& run, std::size_t side);

/// How far the board's points are from the print, along the board's normal, from blue (behind) to orange (in front);
/// `largest_m` comes out as the full colours'.
cv::Mat draw_board_shape(const CalibrationRun& run, double& largest_m);

}  // namespace heartservo::tools
