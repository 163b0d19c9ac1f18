#include "tracking/camera/calibration/calibration.hpp"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "tests/support/board_scene.hpp"
#include "tests/support/message.hpp"
#include "tests/support/table2_camera.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

using test::board_pose;
using test::message_of;
using test::small_board;
using test::table2_camera;

std::vector<BoardPosition> positions_of(std::mt19937_64& random, const Camera& camera,
                                        const std::vector<Eigen::Vector3d>& points,
                                        const std::vector<Eigen::Isometry3d>& poses, double sigma_px) {
  std::vector<BoardPosition> positions;
  for (const auto& T : poses)
    positions.push_back({{"view " + std::to_string(positions.size()), ""},
                         {test::board_corners(random, camera, points, T, sigma_px), {}}});
  return positions;
}

std::vector<BoardPosition> noisy(std::mt19937_64& random, int count, double sigma_px) {
  const Board board = small_board();
  return positions_of(random, table2_camera(), board.points(), test::board_poses(random, table2_camera(), board, count),
                      sigma_px);
}

Calibration calibrate_small(const std::vector<BoardPosition>& positions, BoardShape shape = BoardShape::AUTO) {
  return calibrate(small_board(), 512, 512, 1, positions, {shape});
}

CameraParameters error_of(const Calibration& c) {
  return parameters_of(c.cameras[0].camera) - parameters_of(table2_camera());
}

TEST(Calibration, ExactCornersGiveTheExactCamera) {
  auto random = test::seeded();
  const auto c = calibrate_small(noisy(random, 8, 0));
  EXPECT_LT(error_of(c).head<4>().norm(), 1e-6);
  EXPECT_LT(error_of(c).tail<4>().norm(), 1e-8);
  EXPECT_LT(c.rms_px, 1e-9);
  EXPECT_FALSE(c.free_board);
}

// The normalised squared error of the parameters is chi-squared with 8 degrees of freedom.
TEST(Calibration, ErrorsAreAsLargeAsTheCovarianceSays) {
  constexpr int RUNS = 40;
  auto random = test::seeded();
  double sum = 0;
  CameraParameters z2 = CameraParameters::Zero();
  for (int run = 0; run < RUNS; ++run) {
    const auto c = calibrate_small(noisy(random, 10, 0.2), BoardShape::FLAT);
    EXPECT_NEAR(c.sigma_px, 0.2, 5 * 0.2 / std::sqrt(2.0 * 1192));  // 1260 numbers, 68 unknowns
    EXPECT_NEAR(c.cameras[0].rms_px, c.sigma_px * std::sqrt(1192 / 630.0), 1e-9);
    const CameraParameters e = error_of(c);
    sum += e.dot(c.cameras[0].covariance.ldlt().solve(e));
    z2 += e.cwiseQuotient(c.cameras[0].deviation).cwiseAbs2() / RUNS;
  }
  // chi-squared with 320 degrees of freedom: 320 +- 25.3
  EXPECT_NEAR(sum, 8 * RUNS, 4 * std::sqrt(2.0 * 8 * RUNS));
  for (int k = 0; k < 8; ++k) EXPECT_NEAR(z2[k], 1, 4 * std::sqrt(2.0 / RUNS)) << CAMERA_PARAMETER_NAMES[k];
}

TEST(Calibration, FindsTheMinimumThatOpenCvFinds) {
  auto random = test::seeded();
  const auto positions = noisy(random, 8, 0.3);
  const auto c = calibrate_small(positions, BoardShape::FLAT);
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const auto& position : positions) {
    points.emplace_back();
    pixels.emplace_back();
    for (const auto& p : small_board().points()) points.back().emplace_back(p.x() * 1e3, p.y() * 1e3, 0);
    for (const auto& p : position.corners[0]) pixels.back().emplace_back(p.x(), p.y());
  }
  cv::Mat K, D, intrinsic, extrinsic, per_view;
  std::vector<cv::Mat> R, t;
  const double rms = cv::calibrateCamera(points, pixels, {512, 512}, K, D, R, t, intrinsic, extrinsic, per_view,
                                         cv::CALIB_FIX_K3, {3, 200, 1e-12});
  EXPECT_NEAR(c.rms_px, rms, 1e-5);
  EXPECT_NEAR(c.cameras[0].camera.fx, K.at<double>(0, 0), 0.01);
  EXPECT_NEAR(c.cameras[0].camera.k2, D.at<double>(1), 1e-3);
  // OpenCV divides by the number of points where it has twice as many numbers: its deviations are larger by sqrt 2
  for (int k = 0; k < 8; ++k)
    EXPECT_NEAR(intrinsic.at<double>(k) / c.cameras[0].deviation[k], std::sqrt(2.0), 0.06) << CAMERA_PARAMETER_NAMES[k];
  for (std::size_t i = 0; i < positions.size(); ++i)
    EXPECT_NEAR(c.views[i][0].rms_px, per_view.at<double>(static_cast<int>(i)), 1e-3);
}

TEST(Calibration, ViewsTellWhereTheBoardWas) {
  auto random = test::seeded();
  const auto poses = test::board_poses(random, table2_camera(), small_board(), 6);
  const auto c =
      calibrate_small(positions_of(random, table2_camera(), small_board().points(), poses, 0.05), BoardShape::FLAT);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT((c.views[i][0].T_camera_board.translation() - poses[i].translation()).norm(), 1e-3);
    EXPECT_NEAR(c.views[i][0].tilt_rad, std::acos(poses[i].linear()(2, 2)), 0.02);
    EXPECT_EQ(c.views[i][0].residuals.size(), small_board().size());
    EXPECT_LE(c.views[i][0].rms_px, c.views[i][0].max_px);
  }
}

TEST(Calibration, AnOutlierIsMarked) {
  auto random = test::seeded();
  auto positions = noisy(random, 9, 0.1);
  for (auto& corner : positions[4].corners[0]) corner += Eigen::Vector2d(test::normal(random, 0.8), 0);
  const auto c = calibrate_small(positions);
  for (std::size_t i = 0; i < positions.size(); ++i) EXPECT_EQ(c.views[i][0].outlier, i == 4) << i;
}

TEST(Calibration, CornersThatAreElsewhereAreLeftOutAndNamed) {
  auto random = test::seeded();
  auto positions = noisy(random, 9, 0.1);
  positions[2].corners[0][17] += Eigen::Vector2d(5, -3);
  positions[2].corners[0][40] += Eigen::Vector2d(0, 1.2);
  positions[7].corners[0][0] += Eigen::Vector2d(-2, 0);
  const auto c = calibrate_small(positions, BoardShape::FLAT);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto expected = i == 2   ? std::vector<std::size_t>{17, 40}
                          : i == 7 ? std::vector<std::size_t>{0}
                                   : std::vector<std::size_t>{};
    EXPECT_EQ(c.views[i][0].dropped, expected) << i;
    EXPECT_LT(c.views[i][0].max_px, 0.6);
    EXPECT_FALSE(c.views[i][0].outlier);
  }
  EXPECT_NEAR(c.views[2][0].residuals[17].x(), 5, 0.5);
  EXPECT_EQ(c.positions[2].corners[0][17], positions[2].corners[0][17]);
  EXPECT_NEAR(c.sigma_px, 0.1, 0.01);
  const CameraParameters e = error_of(c);
  EXPECT_LT(e.dot(c.cameras[0].covariance.ldlt().solve(e)), 26.1);
}

// A board bent by 0.1 mm: nothing of it may remain in the camera.
TEST(Calibration, ABentBoardIsSeenAndDoesNoHarm) {
  auto random = test::seeded();
  auto points = small_board().points();
  for (auto& p : points) {
    p.z() += 1e-4 * std::cos(p.x() / 0.005) + 5e-5 * std::sin(p.y() / 0.004);
    p.x() *= 1.004;
  }
  const auto poses = test::board_poses(random, table2_camera(), small_board(), 14);
  const auto positions = positions_of(random, table2_camera(), points, poses, 0.1);
  const auto flat = calibrate_small(positions, BoardShape::FLAT);
  const auto c = calibrate_small(positions);
  EXPECT_GT(flat.rms_px, 0.25) << "noise alone is 0.14";
  EXPECT_TRUE(c.free_board);
  EXPECT_GT(c.shape_evidence, 5);
  EXPECT_NEAR(c.sigma_px, 0.1, 0.005);
  EXPECT_NEAR(c.board_max_m, 1.5e-4, 0.7e-4);
  const CameraParameters e = error_of(c);
  EXPECT_LT(e.dot(c.cameras[0].covariance.ldlt().solve(e)), 26.1) << "chi-squared, 8 degrees of freedom, 0.1 %";
}

TEST(Calibration, AFlatBoardStaysFlat) {
  auto random = test::seeded();
  for (int run = 0; run < 10; ++run) {
    const auto c = calibrate_small(noisy(random, 9, 0.15));
    EXPECT_FALSE(c.free_board);
    EXPECT_NEAR(c.shape_evidence, 1, 0.5);
    EXPECT_EQ(c.board_max_m, 0);
  }
}

TEST(Calibration, ErrorsWithAFreeBoardAreAsLargeAsTheCovarianceSays) {
  constexpr int RUNS = 12;
  auto random = test::seeded();
  double sum = 0;
  for (int run = 0; run < RUNS; ++run) {
    const auto c = calibrate_small(noisy(random, 12, 0.2), BoardShape::FREE);
    EXPECT_TRUE(c.free_board);
    const CameraParameters e = error_of(c);
    sum += e.dot(c.cameras[0].covariance.ldlt().solve(e));
  }
  EXPECT_NEAR(sum, 8 * RUNS, 4 * std::sqrt(2.0 * 8 * RUNS));
}

// Detectors number a board from either end: a bent board must be recognised both ways round.
TEST(Calibration, BoardsNumberedFromTheOtherEndAreTurned) {
  auto random = test::seeded();
  auto points = small_board().points();
  for (auto& p : points) p.z() += 2e-4 * std::sin(p.x() / 0.006) + 0.02 * p.x() * p.y() / 0.01;
  const auto poses = test::board_poses(random, table2_camera(), small_board(), 14);
  auto positions = positions_of(random, table2_camera(), points, poses, 0.1);
  const auto orders = same_looking_orders(small_board());
  for (const std::size_t i : {2u, 5u, 11u}) positions[i].corners[0] = reordered(positions[i].corners[0], orders[1]);
  const auto c = calibrate_small(positions);
  EXPECT_TRUE(c.free_board);
  EXPECT_NEAR(c.sigma_px, 0.1, 0.005);
}

TEST(Calibration, TooFewViewsAreRefused) {
  auto random = test::seeded();
  const auto refusal = [&](int count, BoardShape shape = BoardShape::AUTO) {
    return message_of<InputError>([&] { calibrate_small(noisy(random, count, 0.1), shape); });
  };
  EXPECT_NE(refusal(0).find("0 usable views; take 3 or more"), std::string::npos);
  EXPECT_NE(refusal(2).find("2 usable views; take 3 or more"), std::string::npos);
  EXPECT_EQ(refusal(3), "nothing was thrown");
  EXPECT_NE(refusal(5, BoardShape::FREE).find("cannot be estimated from 5 views; take 6 or more"), std::string::npos);
}

std::vector<BoardPosition> parallel(std::mt19937_64& random, double tilt_rad, double sigma_px) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 8; ++i)
    poses.push_back(board_pose({test::uniform(random, -0.004, 0.004), test::uniform(random, -0.004, 0.004),
                                test::uniform(random, 0.05, 0.065)},
                               tilt_rad, 0.4, 0));
  return positions_of(random, table2_camera(), small_board().points(), poses, sigma_px);
}

TEST(Calibration, BoardsParallelToThePictureDetermineNothing) {
  auto random = test::seeded();
  for (const double sigma : {0.0, 0.1, 0.5})
    for (int run = 0; run < 5; ++run) {
      const auto message = message_of<InputError>([&] { calibrate_small(parallel(random, 0, sigma)); });
      EXPECT_NE(message.find("do not determine fx"), std::string::npos) << sigma << " " << message;
      EXPECT_NE(message.find("tilted"), std::string::npos) << message;
    }
}

// Boards all tilted alike: only the lens's own bending of lines still tells fx, fy, cx, cy apart, if the noise lets it.
TEST(Calibration, BoardsParallelToEachOtherAreRefusedOrSaidToBeVague) {
  auto random = test::seeded();
  const auto good = calibrate_small(noisy(random, 8, 0.1), BoardShape::FLAT);
  int refused = 0;
  for (int run = 0; run < 10; ++run) {
    const auto positions = parallel(random, 0.5, 0.1);
    try {
      const auto c = calibrate_small(positions, BoardShape::FLAT);
      EXPECT_GT(c.cameras[0].deviation[1], 4 * good.cameras[0].deviation[1]);
      EXPECT_LT(error_of(c).cwiseQuotient(c.cameras[0].deviation).cwiseAbs().maxCoeff(), 4.5);
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("do not determine"), std::string::npos) << e.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, 3);
}

TEST(Calibration, OneViewThreeTimesIsNoThreeViews) {
  auto random = test::seeded();
  const auto one = noisy(random, 1, 0.1);
  const auto message = message_of<InputError>([&] { calibrate_small({one[0], one[0], one[0]}); });
  EXPECT_NE(message.find("do not determine"), std::string::npos) << message;
}

}  // namespace
}  // namespace heartservo::tracking
