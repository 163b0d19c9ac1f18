#include "tracking/depth/scale_reference.hpp"

#include <gtest/gtest.h>

#include "tests/support/random.hpp"
#include "tests/support/table2_camera.hpp"
#include "tracking/depth/scale_source.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/landmark/reprojection.hpp"

namespace heartservo::tracking {
namespace {

constexpr double kSide_m = 0.005, kSigma_px = 0.05;

Eigen::Isometry3d tilted_landmark() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = (Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  T.translation() = Eigen::Vector3d(-0.004, 0.003, 0.055);
  return T;
}

// z of the landmark's plane on the ray of the pixel.
double true_depth(const Eigen::Isometry3d& T, const Eigen::Vector2d& px) {
  const Eigen::Vector3d ray = test::table2_camera().normalise(px).homogeneous(), normal = T.linear().col(2);
  return normal.dot(T.translation()) / normal.dot(ray);
}

TEST(ScaleReference, ImpossibleDistancesAreNamed) {
  const auto problem = [](ScaleReference scale) {
    const auto problems = scale.validate();
    return problems.empty() ? std::string() : problems[0];
  };
  EXPECT_EQ(problem({0.05, 1e-3}), "");
  for (const double depth : std::initializer_list<double>{0, -0.05, NAN, INFINITY})
    EXPECT_NE(problem({depth, 1e-3}).find("must be positive"), std::string::npos) << depth;
  for (const double sigma : std::initializer_list<double>{0, -1e-3, NAN, 0.04})
    EXPECT_NE(problem({0.05, sigma}).find("standard deviation"), std::string::npos) << sigma;
  EXPECT_NE(problem({0.05, 1e-3, {5, 0}}).find("edge"), std::string::npos);
}

TEST(ScaleReference, OfALandmarkIsTheDistanceOfItsPlane) {
  const Eigen::Isometry3d T = tilted_landmark();
  const Eigen::Vector2d px(330, 200);
  Frame frame;
  frame.status = FrameStatus::UNREADABLE;  // corners as picked
  Track region;
  region.target = px;
  const auto source = landmark_scale(test::table2_camera(), project_square(test::table2_camera(), T, kSide_m), kSide_m,
                                     0, kSigma_px);
  const ScaleReference scale = source(frame, region);
  EXPECT_TRUE(scale.validate().empty());
  EXPECT_NEAR(scale.depth_m, true_depth(T, px), 1e-8);
  const Eigen::Vector3d normal = T.linear().col(2);
  EXPECT_LT((scale.slope + normal.head<2>() / normal.z()).norm(), 1e-6);
}

TEST(ScaleReference, OfALandmarkHasTheErrorItClaims) {
  const Eigen::Isometry3d T = tilted_landmark();
  const Eigen::Vector2d px(330, 200);
  const double truth = true_depth(T, px);
  auto random = test::seeded();
  double normalised = 0;
  constexpr int kRounds = 400;
  for (int i = 0; i < kRounds; ++i) {
    Quad corners = project_square(test::table2_camera(), T, kSide_m);
    for (auto& c : corners) c += Eigen::Vector2d(test::normal(random, kSigma_px), test::normal(random, kSigma_px));
    TargetState state;
    state.state = TrackState::OK;
    state.T_camera_target = refine_pose(test::table2_camera(), T, kSide_m, corners);
    const auto scale =
        scale_from_landmark(test::table2_camera(), state,
                            pose_covariance(test::table2_camera(), state.T_camera_target, kSide_m, kSigma_px), px, 0);
    normalised += std::pow((scale.depth_m - truth) / scale.sigma_m, 2) / kRounds;
  }
  EXPECT_NEAR(normalised, 1, 0.28);  // four standard deviations of the mean of 400 chi^2
}

TEST(ScaleReference, ALandmarkThatSaysNothingGivesNone) {
  TargetState lost;
  EXPECT_FALSE(scale_from_landmark(test::table2_camera(), lost, Eigen::Matrix<double, 6, 6>::Identity(), {250, 250})
                   .validate()
                   .empty());
  lost.state = TrackState::OK;  // seen from its edge
  lost.T_camera_target.linear() = Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
  lost.T_camera_target.translation().z() = 0.05;
  EXPECT_FALSE(scale_from_landmark(test::table2_camera(), lost, Eigen::Matrix<double, 6, 6>::Identity(), {250, 250})
                   .validate()
                   .empty());
}

}  // namespace
}  // namespace heartservo::tracking
