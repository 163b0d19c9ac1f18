#include "tracking/landmark/dense_estimator.hpp"

#include <gtest/gtest.h>

#include "tests/support/table2_camera.hpp"
#include "tests/tracking/landmark/plate_scene.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

using test::SIDE;
using test::table2_camera;
using test::tilted_pose;
using test::with_noise;

constexpr double DEGREE = M_PI / 180;

/// A plate's picture and its corners with noise of 0.3 px, as a frame and its track.
struct Seen {
  Frame frame;
  Track track;

  Seen(std::mt19937_64& random, const Eigen::Isometry3d& T, std::uint64_t sequence, double blur = test::kPlateBlur,
       double corner_sigma_px = 0.3) {
    const Camera camera = table2_camera();
    const LandmarkTemplate plate(test::wavy_plate(), blur);
    frame.grey = test::plate_picture(random, camera, plate, T, test::some_light(), 3);
    frame.sequence = track.sequence = sequence;
    frame.time_s = track.time_s = static_cast<double>(sequence) / 125;
    track.state = TrackState::OK;
    track.corners = with_noise(random, project_square(camera, T, SIDE), corner_sigma_px);
  }
};

double error_m(const TargetState& state, const Eigen::Isometry3d& truth) {
  return (state.T_camera_target.translation() - truth.translation()).norm();
}

TEST(DenseEstimator, IsFarBetterThanItsCorners) {
  auto random = test::seeded();
  DenseEstimator dense(table2_camera(), SIDE, test::wavy_plate(), 0.3);
  LandmarkEstimator corners(table2_camera(), SIDE, "refined", 0.3);
  double dense2 = 0, corners2 = 0;
  for (int k = 0; k < 20; ++k) {
    const auto truth = tilted_pose(random, 25 * DEGREE, 0.055);
    const Seen seen(random, truth, 100 * k);
    dense.look_at(seen.frame);
    const auto state = dense.estimate(seen.track);
    ASSERT_TRUE(dense.last_dense().valid);
    EXPECT_EQ(state.state, TrackState::OK);
    dense2 += std::pow(error_m(state, truth), 2);
    corners2 += std::pow(error_m(corners.estimate(seen.track), truth), 2);
  }
  EXPECT_LT(std::sqrt(dense2), 0.2 * std::sqrt(corners2));
}

TEST(DenseEstimator, WithoutItsFrameThePoseIsThatOfTheCorners) {
  auto random = test::seeded();
  const auto truth = tilted_pose(random, 25 * DEGREE, 0.055);
  const Seen seen(random, truth, 1), next(random, truth, 2);
  LandmarkEstimator corners(table2_camera(), SIDE, "refined", 0.3);
  const auto expected = corners.estimate(seen.track);
  const auto same = [&](DenseEstimator& dense) {
    const auto state = dense.estimate(seen.track);
    EXPECT_FALSE(dense.last_dense().valid);
    EXPECT_EQ(state.state, TrackState::OK);
    EXPECT_EQ(state.T_camera_target.matrix(), expected.T_camera_target.matrix());
    EXPECT_EQ(state.position_covariance, expected.position_covariance);
  };
  DenseEstimator unseen(table2_camera(), SIDE, test::wavy_plate(), 0.3), another(unseen), broken(unseen), bare(unseen);
  same(unseen);
  another.look_at(next.frame);
  same(another);
  Frame frame = seen.frame;
  frame.grey = cv::Mat();
  broken.look_at(frame);
  same(broken);
  frame.grey = cv::Mat(512, 512, CV_8UC1, cv::Scalar(90));
  bare.look_at(frame);
  same(bare);
}

TEST(DenseEstimator, FindsHowSharpThePictureIs) {
  auto random = test::seeded();
  for (const double ratio : {0.6, 1.6, 2.5}) {
    DenseEstimator dense(table2_camera(), SIDE, test::wavy_plate(), 0.3);
    for (int k = 0; k < 4; ++k) {
      const auto truth = tilted_pose(random, 25 * DEGREE, 0.055);
      const Seen seen(random, truth, 100 * k, ratio * test::kPlateBlur);
      dense.look_at(seen.frame);
      const auto state = dense.estimate(seen.track);
      ASSERT_TRUE(dense.last_dense().valid) << ratio;
      EXPECT_LT(std::abs(state.T_camera_target.translation().z() - truth.translation().z()), 1.5e-4) << ratio;
      if (k > 0) EXPECT_NEAR(dense.last_dense().rms_grey, 3, 0.25) << ratio;
    }
  }
}

// Not told what was printed: all poses share the error of the first one, and otherwise agree.
TEST(DenseEstimator, LearnsAPlateThatItDoesNotKnow) {
  auto random = test::seeded();
  DenseEstimator dense(table2_camera(), SIDE, {}, 0.05);
  const auto middle = tilted_pose(random, 20 * DEGREE, 0.055);
  std::vector<Eigen::Vector3d> errors;
  for (int k = 0; k < 60; ++k) {
    auto truth = middle;
    truth.translation() += std::sin(0.2 * k) * Eigen::Vector3d(0.001, -0.001, 0.003);
    const Seen seen(random, truth, k, test::kPlateBlur, 0.05);
    dense.look_at(seen.frame);
    const auto state = dense.estimate(seen.track);
    ASSERT_TRUE(dense.last_dense().valid) << k;
    if (k >= 40) errors.push_back(state.T_camera_target.translation() - truth.translation());
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), spread = mean;
  for (const auto& e : errors) mean += e / static_cast<double>(errors.size());
  for (const auto& e : errors) spread += (e - mean).cwiseAbs2() / static_cast<double>(errors.size());
  EXPECT_LT(mean.norm(), 3e-4);
  EXPECT_LT(std::sqrt(spread.z()), 6e-5);
  EXPECT_LT(std::sqrt(spread.x() + spread.y()), 1e-5);
}

TEST(DenseEstimator, WrongPicturesAreConfigurationErrors) {
  const Camera camera = table2_camera();
  EXPECT_THROW(DenseEstimator(camera, SIDE, cv::Mat(100, 120, CV_8UC1), 0.05), ConfigError);
  EXPECT_THROW(DenseEstimator(camera, SIDE, cv::Mat(40, 40, CV_8UC1), 0.05), ConfigError);
  EXPECT_THROW(DenseEstimator(camera, SIDE, cv::Mat(100, 100, CV_8UC3), 0.05), ConfigError);
  EXPECT_THROW(DenseEstimator(camera, -1, test::wavy_plate(), 0.05), ConfigError);
}

}  // namespace
}  // namespace heartservo::tracking
