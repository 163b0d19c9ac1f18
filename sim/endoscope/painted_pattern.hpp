#pragma once
// The grey pattern painted on landmarks and on the tool's marker.
#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace heartservo::sim {

/// Edge between the pattern's dark frame and its light rim: |x| or |y|.
inline constexpr double kFrameEdge = 0.84;

/// Grey level (0..255) of pattern `id` at (x, y) in [-1, 1]^2 (x right, y down), the plate's outline being |x|, |y|
/// = 1.
///
/// A sum of smooth random cells of three sizes (a third, an eighth and a fifteenth of the side), each grid turned and
/// shifted by its own irrational amounts so that nothing repeats or is symmetric; pressed towards three paint levels
/// with soft edges; within a dark frame within a light rim, whose common edge |x|, |y| = kFrameEdge is paint against
/// paint and so the same on any tissue: corners picked by hand are refined on it. Gradients are strong in both
/// directions at every scale from the plate to a few pixels, and different ids look different.
double painted_pattern(std::uint32_t id, double x, double y);

/// The pattern as a picture to print, CV_8UC1, outline to outline: pixel (row j, column i) is its mean over
/// x = 2 i / size - 1 ... 2 (i + 1) / size - 1. Painted once in a process, and in those forked from it.
cv::Mat pattern_picture(std::uint32_t id, int size = 512);

}  // namespace heartservo::sim
