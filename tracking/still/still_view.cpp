#include "tracking/still/still_view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace heartservo::tracking {

namespace {

constexpr int kStep_px = 8;        // of the grid on which sources are computed; between its nodes they are interpolated
constexpr double kFade_sides = 1;  // the tracker's model fades out over so many sides of the region

}  // namespace

Eigen::Matrix<double, 2, 3> similarity_between(const Quad& from, const Quad& to) {
  const Eigen::Vector2d f = centre(from), t = centre(to);
  double dot = 0, cross = 0, squares = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = from[i] - f, b = to[i] - t;
    dot += a.dot(b), cross += a.x() * b.y() - a.y() * b.x(), squares += a.squaredNorm();
  }
  const double c = dot / squares, s = cross / squares;
  Eigen::Matrix<double, 2, 3> S;
  S << c, -s, t.x() - c * f.x() + s * f.y(), s, c, t.y() - s * f.x() - c * f.y();
  return S;
}

StillView::StillView(const Quad& region, cv::Size size) : region_(region), size_(size) {
  coarse_.create((size.height - 1) / kStep_px + 2, (size.width - 1) / kStep_px + 2, CV_32FC2);
  fine_.create(size, CV_32FC2);
}

void StillView::find_sources(const TargetTracker& tracker, const Track& track) {
  Quad corners;  // where the tracker's model has the region's corners
  for (std::size_t i = 0; i < 4; ++i) corners[i] = tracker.carry(region_[i]);
  const Eigen::Matrix<double, 2, 3> S =
      similarity_between(region_, is_convex(corners) ? corners : track.corners);
  Eigen::Vector2d low = region_[0], high = region_[0];
  for (const auto& c : region_) low = low.cwiseMin(c), high = high.cwiseMax(c);
  const double fade = kFade_sides * (high - low).norm() / std::sqrt(2.0);
  const auto source = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    const Eigen::Vector2d similar = S * p.homogeneous(), nearest = p.cwiseMax(low).cwiseMin(high);
    const double away = (p - nearest).norm() / fade;
    if (away >= 1) return similar;
    const double weight = 1 - away * away * (3 - 2 * away);
    return similar + weight * (tracker.carry(nearest) - S * nearest.homogeneous());
  };
  for (int j = 0; j < coarse_.rows; ++j)
    for (int i = 0; i < coarse_.cols; ++i) {
      const Eigen::Vector2d q = source(Eigen::Vector2d(i * kStep_px, j * kStep_px));
      coarse_.at<cv::Vec2f>(j, i) = {static_cast<float>(q.x()), static_cast<float>(q.y())};
    }
  for (int v = 0; v < size_.height; ++v) {
    const int j = v / kStep_px;
    const float y = static_cast<float>(v % kStep_px) / kStep_px;
    const cv::Vec2f *upper = coarse_.ptr<cv::Vec2f>(j), *lower = coarse_.ptr<cv::Vec2f>(j + 1);
    auto* row = fine_.ptr<cv::Vec2f>(v);
    for (int u = 0; u < size_.width; ++u) {
      const int i = u / kStep_px;
      const float x = static_cast<float>(u % kStep_px) / kStep_px;
      for (int k = 0; k < 2; ++k) {
        const float a = upper[i][k] + x * (upper[i + 1][k] - upper[i][k]);
        const float b = lower[i][k] + x * (lower[i + 1][k] - lower[i][k]);
        row[u][k] = a + y * (b - a);
      }
    }
  }
}

const cv::Mat& StillView::update(const cv::Mat& picture, const TargetTracker& tracker, const Track& track) {
  if (picture.empty() || picture.size() != size_) return still_;
  if (still_.empty()) still_ = picture.clone();
  if (track.state == TrackState::LOST) return still_;
  find_sources(tracker, track);
  if (ones_.empty()) ones_ = cv::Mat(size_, CV_8UC1, cv::Scalar(255));
  cv::remap(picture, warped_, fine_, {}, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  cv::remap(ones_, inside_, fine_, {}, cv::INTER_NEAREST, cv::BORDER_CONSTANT, 0);
  warped_.copyTo(still_, inside_);
  return still_;
}

}  // namespace heartservo::tracking
