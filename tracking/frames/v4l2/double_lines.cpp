#include <algorithm>
#include <opencv2/core.hpp>

#include "tracking/frames/v4l2/picture_decoder.hpp"

namespace heartservo::tracking::v4l2 {

cv::Mat double_lines(const cv::Mat& picture, bool woven, bool bottom) {
  const int height = woven ? picture.rows : 2 * picture.rows;
  const int first = bottom ? 1 : 0;
  const auto line = [&](int row) { return picture.row(woven ? row : row / 2); };
  cv::Mat whole(height, picture.cols, picture.type());
  for (int row = 0; row < height; ++row) {
    cv::Mat to = whole.row(row);
    const int last = first + 2 * ((height - 1 - first) / 2);
    const int above = std::max(row - 1, first), below = std::min(row + 1, last);
    if (row % 2 == first)
      line(row).copyTo(to);
    else if (row < first || row > last)
      line(row < first ? below : above).copyTo(to);
    else
      cv::addWeighted(line(above), 0.5, line(below), 0.5, 0, to);
  }
  return whole;
}

}  // namespace heartservo::tracking::v4l2
