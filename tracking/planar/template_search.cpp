#include "tracking/planar/template_search.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace heartservo::tracking {

namespace {

constexpr double kSmallestCorrelation = 0.3;

float usable_mean(const Patch& patch) {
  double sum = 0, n = 1e-9;
  for (std::size_t i = 0; i < patch.size(); ++i)
    if (patch.usable[i] > 0) sum += static_cast<double>(patch.grey[i]), ++n;
  return static_cast<float>(sum / n);
}

cv::Mat without_glare(const cv::Mat& picture) {
  const cv::Mat glare = picture >= kSaturatedGrey;
  if (cv::countNonZero(glare) == 0) return picture;
  cv::Mat clear = picture.clone();
  clear.setTo(cv::mean(picture, ~glare), glare);
  return clear;
}

// The template as it looks in the picture's axes under `corners`, at the level's scale; a rectangle cut from it.
cv::Mat draw_template(const Patch& patch, const Quad& corners, float scale, Eigen::Vector2d& centre_offset) {
  double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
  for (const auto& c : corners) {
    left = std::min(left, c.x()), right = std::max(right, c.x());
    top = std::min(top, c.y()), bottom = std::max(bottom, c.y());
  }
  const double s = static_cast<double>(scale);
  const cv::Size size(static_cast<int>(std::lround((right - left) * s)) + 1,
                      static_cast<int>(std::lround((bottom - top) * s)) + 1);
  if (size.width < 4 || size.height < 4 || size.width > 2000 || size.height > 2000) return {};
  Quad to;
  for (std::size_t i = 0; i < 4; ++i) to[i] = (corners[i] - Eigen::Vector2d(left, top)) * s;
  const Eigen::Matrix3d H = homography_between(rectangle(0, 0, patch.width - 1, patch.height - 1), to);
  cv::Mat grey(patch.height, patch.width, CV_32FC1);
  const float mean = usable_mean(patch);
  for (std::size_t i = 0; i < patch.size(); ++i)
    grey.ptr<float>()[i] = patch.grey[i] < kSaturatedGrey ? patch.grey[i] : mean;
  const cv::Matx33d H_cv(H(0, 0), H(0, 1), H(0, 2), H(1, 0), H(1, 1), H(1, 2), H(2, 0), H(2, 1), H(2, 2));
  cv::Mat drawn;
  cv::warpPerspective(grey, drawn, H_cv, size, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  centre_offset = (centre(corners) - Eigen::Vector2d(left, top)) * s;
  return drawn;
}

}  // namespace

int search_level(double side_px, int levels) {
  int level = 0;
  while (level + 1 < levels && side_px / (2 << level) >= 10) ++level;
  return level;
}

std::vector<FoundPlace> find_template(const Patch& patch, const Quad& corners, const PyramidLevel& picture,
                                      const Eigen::Vector2d& around, double radius_px, int count) {
  std::vector<FoundPlace> places;
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  const cv::Mat drawn = is_convex(corners) ? draw_template(patch, corners, picture.scale, offset) : cv::Mat();
  if (drawn.empty() || drawn.cols > picture.cols() || drawn.rows > picture.rows()) return places;
  cv::Mat score;
  cv::matchTemplate(without_glare(picture.floats()), drawn, score, cv::TM_CCOEFF_NORMED);
  const Eigen::Vector2d origin(picture.u0, picture.v0);
  const double s = static_cast<double>(picture.scale);
  for (int row = 0; row < score.rows; ++row)
    for (int column = 0; column < score.cols; ++column) {
      const Eigen::Vector2d place = (Eigen::Vector2d(column, row) + offset + origin) / s;
      float& value = score.at<float>(row, column);
      if (!std::isfinite(value) || (place - around).norm() > radius_px) value = -1;
    }
  for (int i = 0; i < count; ++i) {
    double best = 0;
    cv::Point at;
    cv::minMaxLoc(score, nullptr, &best, nullptr, &at);
    if (best < kSmallestCorrelation) break;
    places.push_back({(Eigen::Vector2d(at.x, at.y) + offset + origin) / s, best});
    const cv::Rect near(at.x - drawn.cols / 4, at.y - drawn.rows / 4, drawn.cols / 2 + 1, drawn.rows / 2 + 1);
    score(near & cv::Rect(0, 0, score.cols, score.rows)).setTo(-1);
  }
  return places;
}

}  // namespace heartservo::tracking
