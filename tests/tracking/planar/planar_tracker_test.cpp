#include "tracking/planar/planar_tracker.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/analytic_image.hpp"
#include "tests/support/random.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/planar/registry.hpp"

namespace heartservo::tracking {
namespace {

const Quad kRegion = rectangle(130, 100, 60, 60);

Frame frame_of(cv::Mat grey, std::uint64_t sequence) {
  Frame frame;
  frame.grey = std::move(grey);
  frame.sequence = sequence;
  frame.time_s = 0.008 * static_cast<double>(sequence);
  return frame;
}

Eigen::Matrix3d moved_by(double x, double y) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Identity();
  H(0, 2) = x;
  H(1, 2) = y;
  return H;
}

cv::Mat picture(double x = 0, double y = 0) { return test::analytic_image(320, 260, moved_by(x, y)); }

// The picture with everything but the region replaced by grey, so that the region can be found in one place only.
cv::Mat lone_region(double x, double y) {
  cv::Mat image(260, 320, CV_8UC1, cv::Scalar(128));
  const cv::Rect window(static_cast<int>(125 + x), static_cast<int>(95 + y), 71, 71);
  picture(x, y)(window).copyTo(image(window));
  return image;
}

double corner_error(const Track& track, double x, double y) {
  double worst = 0;
  for (std::size_t i = 0; i < 4; ++i)
    worst = std::max(worst, (track.corners[i] - kRegion[i] - Eigen::Vector2d(x, y)).norm());
  return worst;
}

std::unique_ptr<TargetTracker> started(const cv::Mat& image = picture()) {
  auto tracker = trackers().make("esm", Camera{}, TrackerOptions{});
  EXPECT_EQ(tracker->start(frame_of(image, 0), kRegion), "");
  return tracker;
}

TEST(PlanarTracker, FollowsAFastSweepAndReportsTheHomography) {
  const auto tracker = started();
  for (std::uint64_t k = 1; k < 40; ++k) {
    const double x = 40 * std::sin(0.15 * static_cast<double>(k)), y = 20 * std::sin(0.23 * static_cast<double>(k));
    const Track track = tracker->track(frame_of(picture(x, y), k));
    ASSERT_EQ(track.state, TrackState::OK) << k;
    EXPECT_LT(corner_error(track, x, y), 0.03) << k;
    EXPECT_LT((transform(track.H_current_reference, kRegion)[2] - track.corners[2]).norm(), 1e-6);
    EXPECT_EQ(track.sequence, k);
  }
}

TEST(PlanarTracker, LostOnNoiseAtOnceAndBackWithinAFrame) {
  auto random = test::seeded();
  const auto tracker = started(lone_region(0, 0));
  cv::Mat noise(260, 320, CV_8UC1);
  for (std::uint64_t k = 1; k < 60; ++k) {
    for (auto& v : cv::Mat_<std::uint8_t>(noise)) v = static_cast<std::uint8_t>(test::uniform(random, 0, 255));
    EXPECT_EQ(tracker->track(frame_of(noise, k)).state, TrackState::LOST) << k;
  }
  const Track track = tracker->track(frame_of(lone_region(60, -40), 60));
  EXPECT_EQ(track.state, TrackState::OK);
  EXPECT_TRUE(track.reacquired);
  EXPECT_LT(corner_error(track, 60, -40), 0.05);
  EXPECT_FALSE(tracker->track(frame_of(lone_region(60, -40), 61)).reacquired);
}

// A heart comes nearer and goes further away while its region is covered: by a sixth in half a beat.
TEST(PlanarTracker, BackWithinTwoFramesAtAnotherDistance) {
  for (const double scale : {1.17, 1 / 1.17}) {
    const auto tracker = started();
    for (std::uint64_t k = 1; k < 5; ++k)
      EXPECT_EQ(tracker->track(frame_of(cv::Mat(260, 320, CV_8UC1, cv::Scalar(128)), k)).state, TrackState::LOST);
    const Eigen::Vector2d middle = centre(kRegion), to = middle + Eigen::Vector2d(31, -17);
    Eigen::Matrix3d H = moved_by(to.x() - scale * middle.x(), to.y() - scale * middle.y());
    H(0, 0) = H(1, 1) = scale;
    Track track = tracker->track(frame_of(test::analytic_image(320, 260, H), 5));
    if (track.state == TrackState::LOST) track = tracker->track(frame_of(test::analytic_image(320, 260, H), 6));
    ASSERT_EQ(track.state, TrackState::OK) << scale;
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_LT((track.corners[i] - transform(H, kRegion)[i]).norm(), 0.05) << scale;
  }
}

TEST(PlanarTracker, LostOnPlainGreyAndOnOtherTexture) {
  const auto tracker = started();
  EXPECT_EQ(tracker->track(frame_of(cv::Mat(260, 320, CV_8UC1, cv::Scalar(100)), 1)).state, TrackState::LOST);
  Eigen::Matrix3d other;
  other << 0.2, -2.1, 700, 2.4, 0.3, -300, 0, 0, 1;
  EXPECT_EQ(tracker->track(frame_of(test::analytic_image(320, 260, other), 2)).state, TrackState::LOST);
}

TEST(PlanarTracker, ABrokenFrameIsLostAndTheNextOneIsNot) {
  const auto tracker = started();
  Frame broken = frame_of({}, 1);
  broken.status = FrameStatus::UNREADABLE;
  const Track lost = tracker->track(broken);
  EXPECT_EQ(lost.state, TrackState::LOST);
  EXPECT_TRUE(is_convex(lost.corners));
  EXPECT_EQ(tracker->track(frame_of(picture().rowRange(0, 200), 2)).state, TrackState::LOST);  // another size
  const Track back = tracker->track(frame_of(picture(3, 2), 3));
  EXPECT_EQ(back.state, TrackState::OK);
  EXPECT_FALSE(back.reacquired);
}

TEST(PlanarTracker, RefusesRegionsItCannotTrackWithTheReason) {
  const auto refusal = [](const cv::Mat& image, const Quad& region) {
    return trackers().make("esm", Camera{}, TrackerOptions{})->start(frame_of(image, 0), region);
  };
  EXPECT_NE(refusal(picture(), rectangle(300, 100, 60, 60)).find("outside"), std::string::npos);
  EXPECT_NE(refusal(picture(), rectangle(100, 100, 8, 60)).find("smaller"), std::string::npos);
  EXPECT_NE(refusal(cv::Mat(260, 320, CV_8UC1, cv::Scalar(80)), kRegion).find("too little texture"), std::string::npos);
  EXPECT_NE(refusal(cv::Mat(260, 320, CV_8UC1, cv::Scalar(255)), kRegion).find("saturated"), std::string::npos);
  Quad twisted = kRegion;
  std::swap(twisted[0], twisted[1]);
  EXPECT_NE(refusal(picture(), twisted).find("clockwise"), std::string::npos);
  Quad nan = kRegion;
  nan[2].x() = std::nan("");
  EXPECT_NE(refusal(picture(), nan).find("finite"), std::string::npos);
}

TEST(PlanarTracker, NotStartedMeansLost) {
  EXPECT_EQ(trackers().make("esm", Camera{}, TrackerOptions{})->track(frame_of(picture(), 0)).state, TrackState::LOST);
}

TEST(TrackerRegistry, SuggestsANearName) {
  try {
    trackers().make("ems", Camera{}, TrackerOptions{});
    FAIL();
  } catch (const ConfigError& e) {
    EXPECT_NE(std::string(e.what()).find("did you mean 'esm'"), std::string::npos);
  }
}

}  // namespace
}  // namespace heartservo::tracking
