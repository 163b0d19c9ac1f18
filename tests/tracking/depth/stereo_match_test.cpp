#include "tracking/depth/stereo_match.hpp"

#include <gtest/gtest.h>

#include "tests/support/message.hpp"
#include "tests/tracking/depth/stereo_scene.hpp"
#include "tracking/depth/scale_source.hpp"
#include "tracking/depth/stereo_depth_estimator.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

const Quad kRegion = rectangle(70, 55, 40, 40);

Eigen::Matrix3d homography(const Quad& region = kRegion) {
  Quad plane;
  for (std::size_t i = 0; i < 4; ++i) plane[i] = test::small_stereo().left.normalise(region[i]);
  return homography_between(rectangle(-1, -1, 2, 2), plane);
}

double true_depth(const test::PaintedPlane& plane) { return plane.depth_at(homography().col(2).hnormalized()); }

struct Views {
  cv::Mat left, right;
};
Views views(const test::PaintedPlane& plane, double noise, std::mt19937_64& random,
            const test::Paint& paint = test::tissue_paint) {
  const StereoCamera stereo = test::small_stereo();
  return {test::see(stereo.left, Eigen::Isometry3d::Identity(), plane, noise, random, paint),
          test::see(stereo.right, stereo.T_right_left, plane, noise, random, paint)};
}

TEST(StereoMatch, FindsTheDepthOfTiltedPlanes) {
  auto random = test::seeded();
  StereoMatcher matcher(test::small_stereo(), {});
  for (const double depth : {0.035, 0.05, 0.08})
    for (const Eigen::Vector2d& slope : {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.4, -0.2)}) {
      const test::PaintedPlane plane{depth, slope};
      const Views v = views(plane, 0, random);
      const StereoMatch m = matcher.match(v.left, v.right, homography(), 40);
      ASSERT_EQ(m.failure, StereoFailure::NONE) << name_of(m.failure) << " " << depth;
      const double truth = true_depth(plane), px = 240 * 0.005 / (truth * truth);  // disparity per metre
      EXPECT_LT(std::abs(m.depth_m - truth) * px, 0.02) << "px, at " << depth;
      EXPECT_LT(std::abs(m.epipolar_px), 0.05);
      EXPECT_GT(m.correlation, 0.98);
    }
}

TEST(StereoMatch, ItsStandardDeviationIsThatOfTheErrors) {
  auto random = test::seeded();
  StereoMatcher matcher(test::small_stereo(), {});
  const test::PaintedPlane plane{0.05, {0.2, 0.1}};
  const Views clean = views(plane, 0, random);
  double normalised = 0;
  constexpr int kRounds = 100;
  for (int i = 0; i < kRounds; ++i) {
    Views v{clean.left.clone(), clean.right.clone()};
    for (cv::Mat* picture : {&v.left, &v.right})
      for (auto& grey : cv::Mat_<std::uint8_t>(*picture))
        grey = cv::saturate_cast<std::uint8_t>(std::lround(grey + test::normal(random, 3)));
    const StereoMatch m = matcher.match(v.left, v.right, homography(), 40);
    ASSERT_EQ(m.failure, StereoFailure::NONE);
    normalised += std::pow((m.depth_m - true_depth(plane)) / m.sigma_m, 2) / kRounds;
  }
  // four standard deviations of the mean of 100 chi^2, and the noise that interpolation smooths
  EXPECT_GT(normalised, 1 - 0.57 - 0.2);
  EXPECT_LT(normalised, 1 + 0.57);
}

TEST(StereoMatch, SaysWhyThereIsNone) {
  auto random = test::seeded();
  StereoMatcher matcher(test::small_stereo(), {});
  const test::PaintedPlane plane{0.05, {0, 0}};
  const Views v = views(plane, 2, random);
  const auto failure = [&](const cv::Mat& left, const cv::Mat& right, const Quad& region = kRegion) {
    return matcher.match(left, right, homography(region), 40).failure;
  };
  EXPECT_EQ(failure(v.left, v.right), StereoFailure::NONE);
  const cv::Mat other = views(plane, 2, random, [](double x, double y) {
                          return test::tissue_paint(1.7 * y + 0.3, -1.2 * x + 0.2);
                        }).right;
  EXPECT_NE(failure(v.left, other), StereoFailure::NONE) << "another tissue";
  EXPECT_NE(failure(v.left, cv::Mat(v.right.size(), CV_8UC1, cv::Scalar(90))), StereoFailure::NONE) << "nothing there";
  EXPECT_NE(failure(v.left, cv::Mat()), StereoFailure::NONE) << "no picture";
  EXPECT_NE(failure(v.left, v.right, rectangle(0, 60, 18, 18)), StereoFailure::NONE) << "out of the right picture";
  const Views stripes = views(plane, 0, random, [](double x, double) { return 120 + 60 * std::sin(3000 * x); });
  EXPECT_EQ(failure(stripes.left, stripes.right), StereoFailure::AMBIGUOUS);
}

TEST(StereoDepth, GivesTheRegionsPoseAndTheScaleOfAFirstFrame) {
  auto random = test::seeded();
  const test::PaintedPlane plane{0.05, {0.3, -0.1}};
  const Views v = views(plane, 1, random);
  Frame frame;
  frame.grey = v.left, frame.right = v.right;
  Track track;
  track.state = TrackState::OK;
  track.corners = kRegion;
  track.target = test::small_stereo().left.to_pixel(
      test::small_stereo().left.distort(homography().col(2).hnormalized()));
  StereoDepthEstimator estimator(test::small_stereo(), {}, 0.05);
  estimator.look_at(frame);
  const TargetState state = estimator.estimate(track);
  ASSERT_EQ(state.state, TrackState::OK);
  EXPECT_NEAR(state.T_camera_target.translation().z(), true_depth(plane), 3e-4);
  const Eigen::Vector3d normal = Eigen::Vector3d(-0.3, 0.1, 1).normalized();
  EXPECT_GT(normal.dot(state.T_camera_target.linear().col(2)), std::cos(0.1));
  EXPECT_GT(state.position_covariance(2, 2), 0);

  const ScaleReference scale = stereo_scale(test::small_stereo(), {})(frame, track);
  EXPECT_TRUE(scale.validate().empty());
  EXPECT_NEAR(scale.depth_m, true_depth(plane), 3e-4);
  frame.right = cv::Mat();
  EXPECT_FALSE(stereo_scale(test::small_stereo(), {})(frame, track).validate().empty()) << "no right view";
  estimator.look_at(frame);
  EXPECT_EQ(estimator.estimate(track).state, TrackState::LOST);
}

TEST(StereoMatch, RefusesWhatItCannotWorkWith) {
  StereoCamera broken = test::small_stereo();
  broken.T_right_left.translation().setZero();
  broken.right.fx = NAN;
  StereoOptions options;
  options.nearest_m = 0.3;
  options.ok_correlation = 0.1;
  const auto message = test::message_of<ConfigError>([&] { StereoMatcher(broken, options); });
  for (const char* part : {"right", "apart", "nearest_m", "ok_correlation"})
    EXPECT_NE(message.find(part), std::string::npos) << message;
}

}  // namespace
}  // namespace heartservo::tracking
