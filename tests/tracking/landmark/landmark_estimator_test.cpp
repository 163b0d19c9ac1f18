#include "tracking/landmark/landmark_estimator.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/random.hpp"
#include "tests/support/table2_camera.hpp"
#include "tests/tracking/landmark/square_scene.hpp"
#include "tracking/landmark/assumed_depth_estimator.hpp"
#include "tracking/landmark/registry.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

using test::SIDE;
using test::table2_camera;
using test::tilted_pose;
using test::with_noise;

constexpr double DEGREE = M_PI / 180;

Track track_of(const Quad& corners, double time_s = 0, TrackState state = TrackState::OK) {
  Track track;
  track.time_s = time_s;
  track.sequence = 7;
  track.state = state;
  track.quality = 0.9;
  track.corners = corners;
  return track;
}

EstimatorOptions options() {
  EstimatorOptions result;
  result.camera = table2_camera();
  return result;
}

// Those that need no more than corners; the ones of tracking/depth have tests of their own.
std::vector<std::string> engines_of_corners() {
  std::vector<std::string> names = estimators().names();
  std::erase_if(names, [](const std::string& name) { return name == "region_depth" || name == "stereo_depth"; });
  return names;
}

TEST(LandmarkEstimator, EveryEngineOfTheRegistryGivesThePositionAndCarriesTheFrameAlong) {
  auto random = test::seeded();
  auto truth = tilted_pose(random, 0.2, 0.055);
  for (const auto& name : engines_of_corners()) {
    const auto estimator = estimators().make(name, options());
    const TargetState state =
        estimator->estimate(track_of(project_square(table2_camera(), truth, SIDE), 1.5, TrackState::UNCERTAIN));
    EXPECT_EQ(state.state, TrackState::UNCERTAIN) << name;
    EXPECT_EQ(state.time_s, 1.5);
    EXPECT_EQ(state.sequence, 7u);
    EXPECT_EQ(state.quality, 0.9);
    const double tolerance = name == "assumed_depth" ? 5e-5 : 1e-6;  // the mean of corners is not the centre's picture
    EXPECT_LT((state.T_camera_target.translation() - truth.translation()).norm(), tolerance) << name;
    EXPECT_GT(state.position_covariance(0, 0), 0) << name;
  }
}

TEST(LandmarkEstimator, LostGoesInOrComesOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Quad good = rectangle(250, 250, 50, 50);
  Quad broken = good;
  broken[3].y() = nan;
  for (const auto& name : engines_of_corners()) {
    const auto estimator = estimators().make(name, options());
    EXPECT_EQ(estimator->estimate(track_of(good, 0, TrackState::LOST)).state, TrackState::LOST) << name;
    EXPECT_EQ(estimator->estimate(track_of(broken)).state, TrackState::LOST) << name;
    EXPECT_EQ(estimator->estimate(track_of(rectangle(1e7, 1e7, nan, 3))).state, TrackState::LOST) << name;
    EXPECT_EQ(estimator->estimate(track_of(good)).state, TrackState::OK) << name << " recovers";
    if (name == "assumed_depth") continue;
    EXPECT_EQ(estimator->estimate(track_of({good[3], good[2], good[1], good[0]})).state, TrackState::LOST) << name;
    EXPECT_EQ(estimator->estimate(track_of({good[0], good[0], good[0], good[0]})).state, TrackState::LOST) << name;
    EXPECT_EQ(estimator->estimate(track_of({good[0], good[2], good[1], good[3]})).state, TrackState::LOST) << name;
  }
}

TEST(LandmarkEstimator, WrongOptionsAreConfigurationErrors) {
  const Camera camera = table2_camera();
  EXPECT_THROW(LandmarkEstimator(camera, SIDE, "refind", 0.05), ConfigError);
  EXPECT_THROW(LandmarkEstimator(camera, 0, "refined", 0.05), ConfigError);
  EXPECT_THROW(LandmarkEstimator(camera, SIDE, "refined", 0), ConfigError);
  EXPECT_THROW(AssumedDepthEstimator(camera, -1), ConfigError);
  EXPECT_THROW(estimators().make("landmark", options()), ConfigError);
}

// Normalised position error squared, summed over POSES poses: chi2 with 3 POSES degrees of freedom if the covariance
// describes the errors.
TEST(LandmarkEstimator, PositionCovarianceDescribesTheErrorsOfEveryMethod) {
  constexpr int POSES = 400;
  for (const std::string method : {"refined", "linear", "visp"}) {
    auto random = test::seeded();
    double sum = 0;
    for (int i = 0; i < POSES; ++i) {
      LandmarkEstimator estimator(table2_camera(), SIDE, method, 0.03);
      const auto truth =
          tilted_pose(random, test::uniform(random, 25, 45) * DEGREE, test::uniform(random, 0.045, 0.065));
      const auto state =
          estimator.estimate(track_of(with_noise(random, project_square(table2_camera(), truth, SIDE), 0.03)));
      ASSERT_EQ(state.state, TrackState::OK);
      const Eigen::Vector3d error = state.T_camera_target.translation() - truth.translation();
      sum += error.dot(state.position_covariance.ldlt().solve(error));
    }
    EXPECT_NEAR(sum, 3 * POSES, 4 * std::sqrt(2.0 * 3 * POSES)) << method;
  }
}

TEST(LandmarkEstimator, AssumedDepthCovarianceDescribesTheErrors) {
  constexpr int DRAWS = 2000;
  auto random = test::seeded();
  const Quad corners = rectangle(420, 60, 40, 30);  // where the lens bends
  AssumedDepthEstimator estimator(table2_camera(), 0.055, 0.2);
  const Eigen::Vector3d mean = estimator.estimate(track_of(corners)).T_camera_target.translation();
  EXPECT_DOUBLE_EQ(mean.z(), 0.055);
  double sum = 0;
  for (int i = 0; i < DRAWS; ++i) {
    const auto state = estimator.estimate(track_of(with_noise(random, corners, 0.2)));
    const Eigen::Vector2d error = (state.T_camera_target.translation() - mean).head<2>();
    sum += error.dot(state.position_covariance.topLeftCorner<2, 2>().ldlt().solve(error));
  }
  EXPECT_NEAR(sum, 2 * DRAWS, 4 * std::sqrt(2.0 * 2 * DRAWS));
}

// A landmark that sways by 4 degrees about a tilt, 125 Hz, 5 Hz beat; counts the frames on the wrong side of the
// ambiguity (nearer to the other solution), with the motion so far and without it.
struct Wrong {
  int with_motion = 0, without = 0, frames = 0;
};

Wrong count_wrong(std::mt19937_64& random, double tilt, double sigma_px) {
  const Camera camera = table2_camera();
  Wrong wrong;
  for (int sequence = 0; sequence < 20; ++sequence) {
    const auto middle = tilted_pose(random, tilt, 0.055);
    LandmarkEstimator following(camera, SIDE, "refined", sigma_px);
    for (int k = 0; k < 250; ++k) {
      const double beat = std::sin(2 * M_PI * 5 * k / 125);
      Eigen::Isometry3d truth = middle;
      truth.translation() += beat * Eigen::Vector3d(0.001, -0.001, 0.003);
      truth.linear() = Eigen::AngleAxisd(4 * DEGREE * beat, Eigen::Vector3d(0.6, 0.8, 0)) * middle.linear();
      const Track track = track_of(with_noise(random, project_square(camera, truth, SIDE), sigma_px), k / 125.0);
      const auto on_wrong_side = [&](const RefinedPose& pose) {
        const auto angle = [&](int i) {
          const auto& T = pose.solutions[i].T_camera_target;
          return Eigen::AngleAxisd(Eigen::Matrix3d(T.linear().transpose() * truth.linear())).angle();
        };
        return angle(1 - pose.taken) < angle(pose.taken) - 1 * DEGREE;
      };
      following.estimate(track);
      wrong.with_motion += on_wrong_side(following.last_refined());
      LandmarkEstimator fresh(camera, SIDE, "refined", sigma_px);
      fresh.estimate(track);
      wrong.without += on_wrong_side(fresh.last_refined());
      ++wrong.frames;
    }
  }
  return wrong;
}

TEST(LandmarkEstimator, MotionKeepsThePoseOnTheRightSideOfTheAmbiguity) {
  auto random = test::seeded();
  for (const auto& [tilt, sigma] : {std::pair{5.0, 0.05}, {10.0, 0.1}, {30.0, 0.1}}) {
    const Wrong wrong = count_wrong(random, tilt * DEGREE, sigma);
    EXPECT_LE(wrong.with_motion, wrong.frames / 500) << tilt << " deg, " << sigma << " px";
  }
  // Corners too noisy for one picture to tell: the motion tells.
  for (const auto& [tilt, sigma] : {std::pair{10.0, 0.2}, {20.0, 0.4}}) {
    const Wrong wrong = count_wrong(random, tilt * DEGREE, sigma);
    RecordProperty("wrong_" + std::to_string(int(tilt)) + "_deg",
                   std::to_string(wrong.without) + " to " + std::to_string(wrong.with_motion));
    EXPECT_GT(wrong.without, 30) << "the case is too easy to show anything";
    EXPECT_LT(wrong.with_motion, wrong.without / 2) << tilt << " deg, " << sigma << " px";
  }
}

TEST(LandmarkEstimator, OldPosesAreNoPrediction) {
  // The pose last seen lies on the wrong side of a square that one picture leaves open; after a long gap it must not
  // count.
  const Camera camera = table2_camera();
  auto random = test::seeded();
  int compared = 0;
  for (int i = 0; i < 200 && compared < 5; ++i) {
    const auto truth = tilted_pose(random, 8 * DEGREE, 0.055);
    const Quad corners = with_noise(random, project_square(camera, truth, SIDE), 0.2);
    const auto free = refined_square_pose(camera, corners, SIDE, {0.2});
    const auto& other = free.solutions[1 - free.taken].T_camera_target;
    if (refined_square_pose(camera, corners, SIDE, {0.2}, other).taken == free.taken) continue;
    const Quad other_corners = project_square(camera, other, SIDE);
    const auto angle_to_other = [&](double gap_s) {
      LandmarkEstimator estimator(camera, SIDE, "refined", 0.2);
      estimator.estimate(track_of(other_corners, 0));
      const auto state = estimator.estimate(track_of(corners, gap_s));
      return Eigen::AngleAxisd(Eigen::Matrix3d(state.T_camera_target.linear().transpose() * other.linear())).angle();
    };
    EXPECT_LT(angle_to_other(0.008), 1e-6);
    EXPECT_GT(angle_to_other(0.26), 1e-3);
    ++compared;
  }
  EXPECT_EQ(compared, 5);
}

}  // namespace
}  // namespace heartservo::tracking
