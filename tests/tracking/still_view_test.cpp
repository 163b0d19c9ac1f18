#include "tracking/still/still_view.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace heartservo::tracking {
namespace {

// Knows how the picture was moved.
struct Knows final : TargetTracker {
  Eigen::Matrix3d H = Eigen::Matrix3d::Identity();
  std::string start(const Frame&, const Quad&) override { return ""; }
  Track track(const Frame&) override { return {}; }
  Eigen::Vector2d carry(const Eigen::Vector2d& p) const override { return (H * p.homogeneous()).hnormalized(); }
  void mark_left_out(cv::Mat&) override {}
};

cv::Mat waves(const Eigen::Matrix3d& H) {  // the pattern, seen through H
  const Eigen::Matrix3d back = H.inverse();
  cv::Mat m(160, 200, CV_8UC1);
  for (int v = 0; v < m.rows; ++v)
    for (int u = 0; u < m.cols; ++u) {
      const Eigen::Vector2d p = (back * Eigen::Vector3d(u, v, 1)).hnormalized();
      m.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(128 + 60 * std::sin(p.x() / 6) * std::cos(p.y() / 7) + 30 * std::sin(p.x() / 17));
    }
  return m;
}

double difference(const cv::Mat& a, const cv::Mat& b, const cv::Rect& where) {
  return cv::norm(a(where), b(where), cv::NORM_L1) / where.area();
}

const Quad kRegion = rectangle(70, 50, 60, 50);
const cv::Rect kInside(72, 52, 56, 46);

Track seen() {
  Track t;
  t.state = TrackState::OK;
  t.corners = kRegion;
  return t;
}

TEST(StillView, UndoesAHomographyInTheRegion) {
  Knows tracker;
  StillView view(kRegion, {200, 160});
  const cv::Mat first = waves(tracker.H);
  EXPECT_EQ(difference(view.update(first, tracker, seen()), first, {0, 0, 200, 160}), 0);
  tracker.H << 1.05, 0.06, 6, -0.05, 0.98, 9, 2e-4, -1e-4, 1;
  const cv::Mat moved = waves(tracker.H), still = view.update(moved, tracker, seen()).clone();
  EXPECT_GT(difference(moved, first, kInside), 10);
  EXPECT_LT(difference(still, first, kInside), 1);
  EXPECT_LT(difference(still, first, {40, 30, 120, 90}), 4);  // around it, about
}

TEST(StillView, FillsWhatIsNoLongerSeenFromThePast) {
  Knows tracker;
  StillView view(kRegion, {200, 160});
  const cv::Mat first = waves(tracker.H);
  view.update(first, tracker, seen());
  tracker.H(0, 2) = 30;  // everything 30 px to the right: the right edge of the still picture lies outside
  const cv::Mat still = view.update(waves(tracker.H), tracker, seen());
  EXPECT_EQ(difference(still, first, {175, 0, 25, 160}), 0);
  EXPECT_LT(difference(still, first, kInside), 1);
}

TEST(StillView, KeepsTheLastPictureWhileTheRegionIsLost) {
  Knows tracker;
  StillView view(kRegion, {200, 160});
  const cv::Mat first = view.update(waves(tracker.H), tracker, seen()).clone();
  Track lost = seen();
  lost.state = TrackState::LOST;
  EXPECT_EQ(difference(view.update(cv::Mat::zeros(160, 200, CV_8UC1), tracker, lost), first, {0, 0, 200, 160}), 0);
  EXPECT_EQ(difference(view.update(cv::Mat(), tracker, seen()), first, {0, 0, 200, 160}), 0);  // an unreadable frame
}

TEST(StillView, TakesColourToo) {
  Knows tracker;
  StillView view(kRegion, {200, 160});
  cv::Mat bgr;
  cv::cvtColor(waves(tracker.H), bgr, cv::COLOR_GRAY2BGR);
  EXPECT_EQ(view.update(bgr, tracker, seen()).type(), CV_8UC3);
}

TEST(StillView, TheSimilarityIsTheNearest) {
  Eigen::Matrix3d H;
  H << 0.9, -0.3, 5, 0.3, 0.9, -7, 0, 0, 1;
  const auto S = similarity_between(kRegion, transform(H, kRegion));
  EXPECT_LT((S - H.topRows<2>()).norm(), 1e-9);
}

}  // namespace
}  // namespace heartservo::tracking
