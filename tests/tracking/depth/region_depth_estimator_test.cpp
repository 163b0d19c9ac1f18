#include "tracking/depth/region_depth_estimator.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/support/message.hpp"
#include "tests/support/random.hpp"
#include "tests/support/table2_camera.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

constexpr double kDepth_m = 0.055, kSigma_px = 0.05;

// Tissue points in the first frame: a grid of 30 mm on a paraboloid, x right, y down, centre first.
struct Tissue {
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d centre{-0.001, 0.002, kDepth_m};

  Tissue(double slope, double curvature) {
    for (int i = 0; i < kGridSide * kGridSide; ++i) {
      const double x = 0.005 * (i % kGridSide - 3), y = 0.005 * (i / kGridSide - 3);
      points.push_back(centre + Eigen::Vector3d(x, y, slope * x + 0.5 * curvature * (x * x + y * y)));
    }
  }
};

// What a tracker says of the tissue moved by T, its points out of place by `shift` (m) and the picture's by `noise_px`.
Track track_of(const Tissue& tissue, const Eigen::Isometry3d& T, double time_s, std::mt19937_64* random = nullptr,
               const std::vector<Eigen::Vector3d>& shift = {}) {
  const Camera camera = test::table2_camera();
  Track track;
  track.time_s = time_s;
  track.state = TrackState::OK;
  track.quality = 1;
  for (std::size_t i = 0; i < tissue.points.size(); ++i) {
    Eigen::Vector3d p = T * tissue.points[i];
    if (!shift.empty()) p += shift[i];
    track.points[i] = camera.project(p);
    if (random)
      track.points[i] += Eigen::Vector2d(test::normal(*random, kSigma_px), test::normal(*random, kSigma_px));
  }
  Eigen::Vector3d c = T * tissue.centre;
  if (!shift.empty()) c += shift[kGridSide * kGridSide / 2];
  track.target = camera.project(c);
  return track;
}

Eigen::Isometry3d motion(const Tissue& tissue, const Eigen::Vector3d& way, const Eigen::Vector3d& turn) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  if (turn.norm() > 0) T.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  T.translation() = tissue.centre + way - T.linear() * tissue.centre;
  return T;
}

ScaleReference scale(double slope_sigma = 0.2) { return {kDepth_m, 1e-6, {0, 0}, slope_sigma}; }

RegionDepthEstimator estimator(const ScaleReference& reference, DepthOptions options = {}) {
  return {test::table2_camera(), known_scale(reference), options, kSigma_px};
}

TEST(RegionDepth, FollowsStiffPlaneTissueExactly) {
  const Tissue tissue(0, 0);
  auto e = estimator(scale());
  e.estimate(track_of(tissue, Eigen::Isometry3d::Identity(), 0));
  for (int i = 1; i < 20; ++i) {
    const Eigen::Vector3d way(0.002 * std::sin(i), 0.001 * std::cos(i), 0.005 * std::sin(0.7 * i));
    const auto state = e.estimate(track_of(tissue, motion(tissue, way, {}), 0.1 * i));
    ASSERT_EQ(state.state, TrackState::OK);
    EXPECT_LT((state.T_camera_target.translation() - tissue.centre - way).norm(), 2e-5) << i;
    EXPECT_LT((state.T_camera_target.linear() - Eigen::Matrix3d::Identity()).norm(), 2e-3);
  }
}

TEST(RegionDepth, TheScaleScalesEverything) {
  const Tissue tissue(0, 0);
  auto twice = estimator({2 * kDepth_m, 2e-6, {0, 0}, 0.2});
  twice.estimate(track_of(tissue, Eigen::Isometry3d::Identity(), 0));
  const auto state = twice.estimate(track_of(tissue, motion(tissue, {0, 0, 0.004}, {}), 0.1));
  EXPECT_NEAR(state.T_camera_target.translation().z(), 2 * (kDepth_m + 0.004), 5e-5);
}

TEST(RegionDepth, LearnsTheShapeFromItsMotion) {
  const Tissue tissue(0.25, 15);
  auto e = estimator(scale());
  double first = 0, last = 0;
  for (int i = 0; i < 150; ++i) {
    const Eigen::Vector3d way(0.002 * std::sin(0.5 * i), 0.002 * std::cos(0.3 * i), 0.006 * std::sin(0.4 * i));
    const Eigen::Vector3d turn(0.05 * std::sin(0.45 * i), 0.05 * std::cos(0.35 * i), 0.02 * std::sin(i));
    const auto T = i == 0 ? Eigen::Isometry3d::Identity() : motion(tissue, way, turn);
    const double error =
        std::abs((e.estimate(track_of(tissue, T, 0.2 * i)).T_camera_target.translation() - T * tissue.centre).z());
    (i < 30 ? first : i >= 120 ? last : first) += i < 30 || i >= 120 ? error / 30 : 0;
  }
  EXPECT_NEAR(e.shape()[0], 0.25, 0.05);
  EXPECT_NEAR(e.shape()[2] / kDepth_m, 15, 6);
  EXPECT_LT(last, 5e-5);
  EXPECT_LT(last, first);
}

// Deformation and noise as assumed, in many drawn frames: the error over its own standard deviation is that of a
// standard normal variable, and no worse of the part that the noise makes.
TEST(RegionDepth, CovarianceIsThatOfTheErrors) {
  const Tissue tissue(0, 0);
  DepthOptions options;
  options.wander_length_m = 0.009;
  const int n = kGridSide * kGridSide, rounds = 400;
  Eigen::MatrixXd alike(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double d = (tissue.points[static_cast<std::size_t>(i)] - tissue.points[static_cast<std::size_t>(j)]).norm();
      alike(i, j) = std::exp(-d * d / (2 * options.wander_length_m * options.wander_length_m)) + (i == j ? 1e-9 : 0);
    }
  const Eigen::MatrixXd L = alike.llt().matrixL();
  auto random = test::seeded();
  double normalised = 0, squared = 0, claimed = 0;
  for (int round = 0; round < rounds; ++round) {
    Eigen::MatrixXd draws(n, 3);
    for (double& v : draws.reshaped()) v = test::normal(random);
    const Eigen::MatrixXd field = L * draws;
    std::vector<Eigen::Vector3d> shift;
    const double two = std::sqrt(2.0);
    for (int i = 0; i < n; ++i)
      shift.emplace_back(two * options.wander_sigma_m * field(i, 0), two * options.wander_sigma_m * field(i, 1),
                         two * options.bulge_sigma_m * field(i, 2));
    const ScaleReference reference{kDepth_m, 1e-4, {0, 0}, 0.01};
    DepthOptions stiff_shape = options;
    stiff_shape.curvature_sigma = 0.5;
    auto e = estimator({kDepth_m + test::normal(random, reference.sigma_m), reference.sigma_m, {0, 0}, 0.01}, stiff_shape);
    e.estimate(track_of(tissue, Eigen::Isometry3d::Identity(), 0));
    const Eigen::Vector3d turn(test::normal(random, options.tilt_sigma_rad), test::normal(random, options.tilt_sigma_rad),
                               test::normal(random, 0.05));
    const Eigen::Vector3d way(test::normal(random, 1e-3), test::normal(random, 1e-3), test::normal(random, 1e-3));
    const auto state = e.estimate(track_of(tissue, motion(tissue, way, turn), 0.1, &random, shift));
    ASSERT_EQ(state.state, TrackState::OK);
    const double truth = kDepth_m + way.z() + shift[static_cast<std::size_t>(n / 2)].z();
    const double variance = state.position_covariance(2, 2) + state.lasting_covariance(2, 2);
    const double error = state.T_camera_target.translation().z() - truth;
    normalised += error * error / variance / rounds;
    squared += error * error / rounds;
    claimed += variance / rounds;
    EXPECT_LT(state.position_covariance(2, 2), 0.2 * variance) << "noise is the smaller part";
  }
  // chi^2 of 400: standard deviation of the mean 0.07; 4 of them
  EXPECT_NEAR(normalised, 1, 0.28) << "error " << 1e3 * std::sqrt(squared) << " mm, claimed "
                                   << 1e3 * std::sqrt(claimed) << " mm";
}

TEST(RegionDepth, IsLostWhereThereIsNothingToGoBy) {
  const Tissue tissue(0, 0);
  auto e = estimator(scale());
  Track lost = track_of(tissue, Eigen::Isometry3d::Identity(), 0);
  lost.state = TrackState::LOST;
  EXPECT_EQ(e.estimate(lost).state, TrackState::LOST);
  EXPECT_EQ(e.scale().depth_m, 0) << "not yet fixed";
  EXPECT_EQ(e.estimate(track_of(tissue, Eigen::Isometry3d::Identity(), 0.1)).state, TrackState::OK);
  Track broken = track_of(tissue, Eigen::Isometry3d::Identity(), 0.2);
  broken.points[3].x() = NAN;
  EXPECT_EQ(e.estimate(broken).state, TrackState::LOST);
  RegionDepthEstimator unknown(test::table2_camera(), known_scale({}), {}, kSigma_px);
  EXPECT_EQ(unknown.estimate(track_of(tissue, Eigen::Isometry3d::Identity(), 0)).state, TrackState::LOST);
}

TEST(RegionDepth, NamesEveryProblemOfItsOptions) {
  DepthOptions options;
  options.wander_sigma_m = 0;
  options.bulge_sigma_m = NAN;
  options.memory_s = -1;
  const auto message = test::message_of<ConfigError>(
      [&] { RegionDepthEstimator(test::table2_camera(), nullptr, options, 0); });
  for (const char* part : {"wander_sigma_m", "bulge_sigma_m", "memory_s", "depth.source", "corner sigma"})
    EXPECT_NE(message.find(part), std::string::npos) << message;
}

}  // namespace
}  // namespace heartservo::tracking
