#pragma once
// Boards in pictures.
#include <opencv2/core/mat.hpp>
#include <string>

#include "tracking/camera/calibration/board.hpp"

namespace heartservo::tracking {

struct BoardDetection {
  Corners corners;        ///< px, not mirrored; empty when no board was found
  std::string problem;    ///< why none was
  double disc_ratio = 0;  ///< circles: diameter over pitch, as the picture shows it; 0 for a chessboard
};

/// Finds the whole board in a grey picture (8 bit). A chessboard's corners are refined where lines of grey meet, in
/// windows as large as the squares allow; circles, dark on light or light on dark, are found at the centre of gravity
/// of their darkness against the paper around them. Never throws.
BoardDetection detect_board(const cv::Mat& grey, const Board& board);

}  // namespace heartservo::tracking
