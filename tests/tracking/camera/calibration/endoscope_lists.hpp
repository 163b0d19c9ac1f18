#pragma once
// The corner lists of a real stereo endoscope: a chessboard of 14 x 10 corners, 3 mm squares, nine views a side.
#include <string>
#include <vector>

#include "tests/support/files.hpp"
#include "tracking/camera/calibration/board_adjustment.hpp"
#include "tracking/camera/calibration/corner_list.hpp"

namespace heartservo::test::endoscope {

inline const tracking::Board BOARD{tracking::BoardKind::CHESSBOARD, 14, 10, 0.003, 0};
inline const char* const VIEWS[] = {"798", "1095", "1338", "1884", "2520", "3083", "3335", "3685", "4848"};

inline std::filesystem::path folder() { return data("endoscope_calib"); }

inline tracking::Corners corners_of(const std::string& side, const std::string& view) {
  return tracking::read_corner_list((folder() / side / (side + "-" + view + ".png.points.txt")).string(), BOARD, 1920,
                                    1080);
}

inline std::vector<tracking::BoardPosition> positions_of(const std::vector<std::string>& sides) {
  std::vector<tracking::BoardPosition> positions;
  for (const std::string view : VIEWS) {
    positions.emplace_back();
    for (std::size_t k = 0; k < sides.size(); ++k) positions.back().corners[k] = corners_of(sides[k], view);
  }
  return positions;
}

}  // namespace heartservo::test::endoscope
