#pragma once
// The way to the first minimum: each camera alone from closed forms, then both together.
#include "tracking/camera/calibration/board_adjustment.hpp"

namespace heartservo::tracking {

/// The camera of one side and the poses of the board, flat. Positions that the side did not see keep an identity pose.
/// Throws InputError where nothing fits.
BoardAdjustment calibrate_one_camera(const Board& board, int width, int height,
                                     const std::vector<BoardPosition>& positions, std::size_t side);

/// Both cameras, from each alone. Throws InputError with fewer than three positions that both saw.
BoardAdjustment calibrate_two_cameras(const Board& board, const BoardAdjustment& left, const BoardAdjustment& right,
                                      const std::vector<BoardPosition>& positions);

}  // namespace heartservo::tracking
