#include "tools/image_motion.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace heartservo::tools {

namespace {

constexpr double kInner = 0.9;  // of the region: its rim is another thing's neighbour
constexpr int kAround_px = 80;  // of it, in which it is looked for: more than a heart moves

}  // namespace

ImageMotion::ImageMotion(const tracking::Quad& region) {
  Eigen::Vector2d low = region[0], high = region[0];
  for (const auto& c : region) low = low.cwiseMin(c), high = high.cwiseMax(c);
  const Eigen::Vector2d middle = 0.5 * (low + high), half = 0.5 * kInner * (high - low);
  region_ = cv::Rect(cvRound(middle.x() - half.x()), cvRound(middle.y() - half.y()), std::max(1, cvRound(2 * half.x())),
                     std::max(1, cvRound(2 * half.y())));
  flow_ = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
  flow_->setFinestScale(0);
}

ImageMotion::~ImageMotion() = default;

Eigen::Vector2d ImageMotion::add(const cv::Mat& grey) {
  if (grey.empty()) return Eigen::Vector2d::Constant(NAN);
  if (first_.empty()) {
    const cv::Rect picture(0, 0, grey.cols, grey.rows);
    region_ &= picture;
    around_ = cv::Rect(region_.x - kAround_px, region_.y - kAround_px, region_.width + 2 * kAround_px,
                       region_.height + 2 * kAround_px) & picture;
    first_ = grey(around_).clone();
    sums_.assign(static_cast<std::size_t>(region_.area()), Eigen::Vector2d::Zero());
    squares_.assign(sums_.size(), 0);
    displacement_ = cv::Mat::zeros(around_.size(), CV_32FC2);
  } else {
    grey(around_).copyTo(now_);
    flow_->calc(first_, now_, displacement_);  // what it holds from the picture before is where the search starts
  }
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  std::size_t i = 0;
  for (int v = region_.y; v < region_.y + region_.height; ++v)
    for (int u = region_.x; u < region_.x + region_.width; ++u, ++i) {
      const cv::Vec2f& f = displacement_.at<cv::Vec2f>(v - around_.y, u - around_.x);
      const Eigen::Vector2d d(f[0], f[1]);
      sums_[i] += d;
      squares_[i] += d.squaredNorm();
      mean += d;
    }
  ++count_;
  return mean / static_cast<double>(std::max<std::size_t>(1, i));
}

double ImageMotion::rms_px() const {
  if (count_ == 0 || sums_.empty()) return 0;
  const auto n = static_cast<double>(count_);
  double sum = 0;
  for (std::size_t i = 0; i < sums_.size(); ++i) sum += squares_[i] / n - (sums_[i] / n).squaredNorm();
  return std::sqrt(std::max(0.0, sum / static_cast<double>(sums_.size())));
}

}  // namespace heartservo::tools
