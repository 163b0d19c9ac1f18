#include <gtest/gtest.h>

#include "tests/support/board_scene.hpp"
#include "tests/support/message.hpp"
#include "tests/support/table2_camera.hpp"
#include "tracking/camera/calibration/calibration.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

using test::message_of;
using test::small_board;
using test::table2_camera;

Camera right_camera() {
  Camera camera = table2_camera();
  camera.fx = 600;
  camera.fy = 602;
  camera.cx = 240;
  camera.k1 = -0.22;
  return camera;
}

Eigen::Isometry3d true_rig() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(0.08, Eigen::Vector3d(0.1, 1, 0.05).normalized()).matrix();
  T.translation() << -0.0047, 0.0001, 0.0003;
  return T;
}

std::vector<BoardPosition> pairs(std::mt19937_64& random, int count, double sigma_px) {
  const auto points = small_board().points();
  std::vector<BoardPosition> positions;
  for (const auto& T : test::board_poses(random, table2_camera(), small_board(), count))
    positions.push_back({{"left", "right"},
                         {test::board_corners(random, table2_camera(), points, T, sigma_px),
                          test::board_corners(random, right_camera(), points, true_rig() * T, sigma_px)}});
  return positions;
}

Calibration calibrate_pairs(const std::vector<BoardPosition>& positions, BoardShape shape = BoardShape::FLAT) {
  return calibrate(small_board(), 512, 512, 2, positions, {shape});
}

// Error of T_right_left as a twist about the truth.
Eigen::Matrix<double, 6, 1> rig_error(const Calibration& c) {
  Eigen::Matrix<double, 6, 1> e;
  e.head<3>() = c.rig.T_right_left.translation() - true_rig().translation();
  const Eigen::AngleAxisd w(Eigen::Matrix3d(c.rig.T_right_left.linear() * true_rig().linear().transpose()));
  e.tail<3>() = w.angle() * w.axis();
  return e;
}

TEST(StereoCalibration, ExactCornersGiveTheExactRig) {
  auto random = test::seeded();
  const auto c = calibrate_pairs(pairs(random, 6, 0));
  EXPECT_LT(rig_error(c).head<3>().norm(), 1e-9);
  EXPECT_LT(rig_error(c).tail<3>().norm(), 1e-8);
  EXPECT_LT((parameters_of(c.cameras[1].camera) - parameters_of(right_camera())).norm(), 1e-5);
}

TEST(StereoCalibration, ErrorsOfTheRigAreAsLargeAsItsCovarianceSays) {
  constexpr int RUNS = 25;
  auto random = test::seeded();
  double rig = 0, right = 0;
  for (int run = 0; run < RUNS; ++run) {
    const auto c = calibrate_pairs(pairs(random, 8, 0.2));
    const auto e = rig_error(c);
    rig += e.dot(c.rig_covariance.ldlt().solve(e));
    const CameraParameters r = parameters_of(c.cameras[1].camera) - parameters_of(right_camera());
    right += r.dot(c.cameras[1].covariance.ldlt().solve(r));
    EXPECT_NEAR(c.pair_strain, 1, 0.05);
    EXPECT_NEAR(c.sigma_px, 0.2, 0.015);
  }
  EXPECT_NEAR(rig, 6 * RUNS, 4 * std::sqrt(2.0 * 6 * RUNS));
  EXPECT_NEAR(right, 8 * RUNS, 4 * std::sqrt(2.0 * 8 * RUNS));
}

TEST(StereoCalibration, PositionsThatOneSideMissedAreUsedToo) {
  auto random = test::seeded();
  auto positions = pairs(random, 8, 0.1);
  positions[1].corners[0].clear();
  positions[5].corners[1].clear();
  const auto c = calibrate_pairs(positions);
  EXPECT_FALSE(c.views[1][0].seen);
  EXPECT_TRUE(c.views[1][1].seen);
  EXPECT_TRUE(c.views[5][0].seen);
  EXPECT_LT(rig_error(c).head<3>().norm(), 2e-4);
  for (std::size_t p = 0; p < 2; ++p) positions[p].corners[1].clear();
  for (std::size_t p = 2; p < 6; ++p) positions[p].corners[0].clear();
  positions[6].corners[1].clear();
  positions[0] = pairs(random, 1, 0.1)[0];
  positions[0].corners[1].clear();
  const auto message = message_of<InputError>([&] { calibrate_pairs(positions); });
  EXPECT_NE(message.find("only 1 pairs show the board on both sides"), std::string::npos) << message;
}

TEST(StereoCalibration, PairsThatDoNotBelongTogetherAreSeen) {
  auto random = test::seeded();
  auto positions = pairs(random, 8, 0.1);
  for (std::size_t p = 0; p + 1 < positions.size(); ++p)
    std::swap(positions[p].corners[1], positions[p + 1].corners[1]);
  const auto message = message_of<InputError>([&] { calibrate_pairs(positions); });
  EXPECT_NE(message.find("times worse together than alone"), std::string::npos) << message;
  auto late = pairs(random, 8, 0.1);  // the board went on by 0.1 mm before the right picture was taken
  const auto poses = test::board_poses(random, table2_camera(), small_board(), 8);
  for (std::size_t p = 0; p < late.size(); ++p) {
    Eigen::Isometry3d moved = poses[p];
    moved.translation() += Eigen::Vector3d(test::normal(random, 3e-5), test::normal(random, 3e-5), 0);
    late[p].corners = {test::board_corners(random, table2_camera(), small_board().points(), poses[p], 0.1),
                       test::board_corners(random, right_camera(), small_board().points(), true_rig() * moved, 0.1)};
  }
  EXPECT_GT(calibrate_pairs(late).pair_strain, 1.3);
}

TEST(StereoCalibration, ABentBoardIsFoundWithBothEyes) {
  auto random = test::seeded();
  auto points = small_board().points();
  for (auto& p : points) p.z() += 1.5e-4 * std::cos(p.x() / 0.005);
  std::vector<BoardPosition> positions;
  for (const auto& T : test::board_poses(random, table2_camera(), small_board(), 8))
    positions.push_back({{"left", "right"},
                         {test::board_corners(random, table2_camera(), points, T, 0.1),
                          test::board_corners(random, right_camera(), points, true_rig() * T, 0.1)}});
  const auto c = calibrate_pairs(positions, BoardShape::AUTO);
  EXPECT_TRUE(c.free_board);
  EXPECT_NEAR(c.sigma_px, 0.1, 0.006);
  const auto e = rig_error(c);
  EXPECT_LT(e.dot(c.rig_covariance.ldlt().solve(e)), 22.5) << "chi-squared, 6 degrees of freedom, 0.1 %";
}

}  // namespace
}  // namespace heartservo::tracking
