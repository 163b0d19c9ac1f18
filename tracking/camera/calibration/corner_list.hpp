#pragma once
#include <string>

#include "tracking/camera/calibration/board.hpp"

namespace heartservo::tracking {

/// Corners from a text file: `u v` a line in px, separated by blanks, a comma or a semicolon, row by row of the board;
/// '#' begins a comment, and a first line without a number is a header. Throws InputError naming file and line: no such
/// file, no number, not finite, outside the picture of `width` x `height` px, another count than the board has, or
/// what grid_problem() says.
Corners read_corner_list(const std::string& file, const Board& board, int width, int height);

}  // namespace heartservo::tracking
