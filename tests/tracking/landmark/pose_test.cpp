// The three ways from four corners to a pose, on poses that are known.
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/random.hpp"
#include "tests/support/table2_camera.hpp"
#include "tests/tracking/landmark/square_scene.hpp"
#include "tracking/landmark/ippe_pose.hpp"
#include "tracking/landmark/refined_pose.hpp"
#include "tracking/landmark/square_pose.hpp"
#include "tracking/landmark/visp_pose.hpp"

namespace heartservo::tracking {
namespace {

using test::normalised_corners;
using test::SIDE;
using test::table2_camera;
using test::tilted_pose;
using test::with_noise;

constexpr double DEGREE = M_PI / 180;

double angle_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle();
}

TEST(SquarePose, EveryMethodIsExactWithoutNoise) {
  const Camera camera = table2_camera();
  auto random = test::seeded();
  for (const double tilt : {0.0, 5.0, 10.0, 20.0, 30.0, 45.0})
    for (const double z : {0.045, 0.055, 0.065})
      for (int i = 0; i < 10; ++i) {
        const auto truth = tilted_pose(random, tilt * DEGREE, z);
        const Quad corners = project_square(camera, truth, SIDE);
        const auto normalised = normalised_corners(camera, corners);
        const auto linear = linear_square_pose(normalised, SIDE);
        const auto refined = refined_square_pose(camera, corners, SIDE);
        const auto visp = visp_square_pose(normalised, SIDE);
        ASSERT_GE(refined.taken, 0);
        ASSERT_TRUE(visp.has_value());
        const auto& best = refined.solutions[refined.taken];
        EXPECT_LT((linear.translation() - truth.translation()).norm(), 1e-10) << tilt;
        EXPECT_LT(angle_between(linear, truth), 1e-7) << tilt;
        EXPECT_LT((best.T_camera_target.translation() - truth.translation()).norm(), 1e-10) << tilt;
        EXPECT_LT(angle_between(best.T_camera_target, truth), 1e-6) << tilt;
        EXPECT_LT(best.rms_px, 1e-9);
        EXPECT_LT((visp->translation() - truth.translation()).norm(), 1e-6) << tilt;
        EXPECT_LT(angle_between(*visp, truth), 1e-3) << tilt;
      }
}

TEST(SquarePose, LinearRotationIsARotationWithNoiseToo) {
  const Camera camera = table2_camera();
  auto random = test::seeded();
  for (int i = 0; i < 50; ++i) {
    const Quad corners = with_noise(random, project_square(camera, tilted_pose(random, 0.5, 0.055), SIDE), 1.0);
    const Eigen::Matrix3d R = linear_square_pose(normalised_corners(camera, corners), SIDE).linear();
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(R.determinant(), 1, 1e-12);
  }
}

TEST(SquarePose, IppeGivesTheTruthAndItsMirrorTilt) {
  const Camera camera = table2_camera();
  auto random = test::seeded();
  for (int i = 0; i < 50; ++i) {
    const auto truth = tilted_pose(random, 30 * DEGREE, 0.055);
    std::array<Eigen::Isometry3d, 2> poses;
    ASSERT_TRUE(ippe_square_poses(normalised_corners(camera, project_square(camera, truth, SIDE)), SIDE, poses));
    EXPECT_LT((poses[0].matrix() - truth.matrix()).norm(), 1e-6);
    EXPECT_GT(angle_between(poses[1], truth), 30 * DEGREE);
    EXPECT_LT((poses[1].translation() - truth.translation()).norm(), 1e-3);
    EXPECT_GT(poses[1].linear()(2, 2), 0) << "z away from the camera";
  }
}

TEST(SquarePose, JacobianIsTheDerivative) {
  const Camera camera = table2_camera();
  auto random = test::seeded();
  for (int i = 0; i < 50; ++i) {
    const auto T = tilted_pose(random, 0.6, 0.05);
    const auto corners = [&](const Eigen::VectorXd& twist) -> Eigen::VectorXd {
      const Quad quad = project_square(camera, moved(T, twist), SIDE);
      Vector8d all;
      all << quad[0], quad[1], quad[2], quad[3];
      return all;
    };
    const Eigen::MatrixXd numeric = test::numeric_jacobian(corners, Eigen::VectorXd::Zero(6), 1e-6);
    const Jacobian8x6 J = square_jacobian(camera, T, SIDE);
    for (int col = 0; col < 6; ++col)
      EXPECT_LT((J.col(col) - numeric.col(col)).norm(), 1e-6 * J.col(col).norm()) << "column " << col;
  }
}

TEST(SquarePose, BadCornersGiveNoPoseAndNoException) {
  const Camera camera = table2_camera();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Quad good = rectangle(250, 250, 50, 50);
  Quad broken = good, line = good, mirrored{good[3], good[2], good[1], good[0]}, far = good;
  broken[1].x() = nan;
  for (int i = 0; i < 4; ++i) line[i] = Eigen::Vector2d(200 + 20 * i, 200 + 20 * i);
  far[2].x() = std::numeric_limits<double>::infinity();
  for (const Quad& corners : {broken, line, mirrored, far, Quad{good[0], good[0], good[0], good[0]}}) {
    const auto refined = refined_square_pose(camera, corners, SIDE);
    EXPECT_EQ(refined.taken, -1);
    EXPECT_TRUE(std::isnan(refined.solutions[0].rms_px));
    EXPECT_NO_THROW(visp_square_pose(normalised_corners(camera, corners), SIDE));
    EXPECT_NO_THROW(linear_square_pose(normalised_corners(camera, corners), SIDE));
  }
}

// Standard deviation of the depth error (m) of both methods over random poses of one tilt, 0.1 px of corner noise.
std::pair<double, double> depth_std(std::mt19937_64& random, double tilt) {
  const Camera camera = table2_camera();
  double linear_sum = 0, refined_sum = 0;
  constexpr int POSES = 2000;
  for (int i = 0; i < POSES; ++i) {
    const auto truth = tilted_pose(random, tilt, test::uniform(random, 0.045, 0.065));
    const Quad corners = with_noise(random, project_square(camera, truth, SIDE), 0.1);
    const double linear = linear_square_pose(normalised_corners(camera, corners), SIDE).translation().z();
    const auto refined = refined_square_pose(camera, corners, SIDE, {0.1});
    const double z = truth.translation().z();
    linear_sum += (linear - z) * (linear - z);
    const double error = refined.solutions[refined.taken].T_camera_target.translation().z() - z;
    refined_sum += error * error;
  }
  return {std::sqrt(linear_sum / POSES), std::sqrt(refined_sum / POSES)};
}

TEST(SquarePose, RefinedDepthIsSeveralTimesBetterThanLinearOnATiltedSquare) {
  auto random = test::seeded();
  for (const auto& [tilt, factor] : {std::pair{0.0, 0.95}, {10.0, 2.0}, {30.0, 4.0}}) {
    const auto [linear, refined] = depth_std(random, tilt * DEGREE);
    RecordProperty("ratio_" + std::to_string(int(tilt)) + "_deg", std::to_string(linear / refined));
    EXPECT_GT(linear / refined, factor) << tilt;
  }
}

TEST(SquarePose, CovarianceDescribesTheErrors) {
  const Camera camera = table2_camera();
  auto random = test::seeded();
  constexpr int POSES = 500;
  constexpr double SIGMA = 0.05;
  double position = 0, pose = 0;
  for (int i = 0; i < POSES; ++i) {
    const auto truth = tilted_pose(random, test::uniform(random, 25, 45) * DEGREE, test::uniform(random, 0.045, 0.065));
    const Quad corners = with_noise(random, project_square(camera, truth, SIDE), SIGMA);
    const auto result = refined_square_pose(camera, corners, SIDE, {SIGMA});
    const auto& T = result.solutions[result.taken].T_camera_target;
    Eigen::Matrix<double, 6, 1> error;
    const Eigen::AngleAxisd rotation(Eigen::Matrix3d(T.linear() * truth.linear().transpose()));
    error << T.translation() - truth.translation(), rotation.angle() * rotation.axis();
    pose += error.dot(result.covariance.ldlt().solve(error));
    position += error.head<3>().dot(result.covariance.topLeftCorner<3, 3>().ldlt().solve(error.head<3>()));
  }
  // Sums of squared normal deviates: chi2 with 500 * 6 and 500 * 3 degrees of freedom, mean n, variance 2 n; 4 sigma.
  EXPECT_NEAR(pose, POSES * 6, 4 * std::sqrt(2.0 * POSES * 6));
  EXPECT_NEAR(position, POSES * 3, 4 * std::sqrt(2.0 * POSES * 3));
}

}  // namespace
}  // namespace heartservo::tracking
