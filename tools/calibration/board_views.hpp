#pragma once
// The views of a calibration, from pictures or from corner lists.
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "tracking/camera/calibration/board_adjustment.hpp"

namespace heartservo::tools {

struct ViewSources {
  std::vector<std::string> left, right;  ///< files or folders; right is empty for one camera
  bool are_lists = false;                ///< of corners, else pictures
  int width = 0, height = 0;             ///< px, of lists
  bool quiet = false;                    ///< no progress
};

struct SkippedView {
  std::string name, reason;
};

struct BoardViews {
  tracking::Board board;  ///< with the diameter of its circles, if it has any and they were seen
  int width = 0, height = 0;
  std::size_t sides = 1, given = 0;  ///< given: files, both sides together
  std::vector<tracking::BoardPosition> positions;
  std::vector<SkippedView> skipped;
};

/// Pictures without the board, damaged or of another size are skipped, with the reason. Throws ConfigError: another
/// number of right views; InputError: a file that is not there, a list that is no picture of the board, no view at all.
BoardViews collect_views(const tracking::Board& board, const ViewSources& sources);

}  // namespace heartservo::tools
