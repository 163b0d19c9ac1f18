// Boards drawn through the paper's lens, found in the pictures, and the camera that they give.
#include "tracking/camera/calibration/board_detection.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/support/board_scene.hpp"
#include "tests/support/table2_camera.hpp"
#include "tracking/camera/calibration/calibration.hpp"

namespace heartservo::tracking {
namespace {

using test::small_board;
using test::table2_camera;

struct Found {
  std::vector<BoardPosition> positions;
  std::vector<Corners> truth;
  std::vector<double> disc_ratios;
};

// Root mean square distance from where the points truly are.
double error_px(const std::vector<BoardPosition>& positions, const std::vector<Corners>& truth) {
  double sum = 0, count = 0;
  for (std::size_t p = 0; p < positions.size(); ++p)
    for (std::size_t i = 0; i < truth[p].size(); ++i, ++count)
      sum += (positions[p].corners[0][i] - truth[p][i]).squaredNorm();
  return std::sqrt(sum / count);
}

Found find_all(Board board, double blur_px, double sigma_grey, int count) {
  static const test::BoardPainter painter(table2_camera());
  auto random = test::seeded();
  Found found;
  for (const auto& T : test::board_poses(random, table2_camera(), board, count)) {
    cv::Mat picture = painter.paint(board, T, 0, random);
    cv::GaussianBlur(picture, picture, {}, blur_px);
    cv::Mat noise(picture.size(), CV_16SC1);
    for (auto& n : cv::Mat_<short>(noise)) n = static_cast<short>(std::lround(test::normal(random, sigma_grey)));
    cv::add(picture, noise, picture, {}, CV_8U);
    const auto detection = detect_board(picture, board);
    EXPECT_EQ(detection.problem, "");
    if (detection.corners.empty()) continue;
    Corners truth;
    for (const auto& p : board.points()) truth.push_back(table2_camera().project(T * p));
    const auto corners =
        reordered(detection.corners, same_looking_orders(board)[order_like(board, detection.corners, truth)]);
    found.positions.push_back({{"rendered", ""}, {corners, {}}});
    found.truth.push_back(truth);
    found.disc_ratios.push_back(detection.disc_ratio);
  }
  return found;
}

void expect_camera_within(const Calibration& c, double sigmas) {
  const CameraParameters e = parameters_of(c.cameras[0].camera) - parameters_of(table2_camera());
  for (int k = 0; k < 8; ++k)
    EXPECT_LT(std::abs(e[k]), sigmas * c.cameras[0].deviation[k])
        << CAMERA_PARAMETER_NAMES[k] << " " << e[k] << " +- " << c.cameras[0].deviation[k];
}

TEST(BoardDetection, ChessboardPicturesGiveTheCamera) {
  const auto found = find_all(small_board(), 0.7, 2, 12);
  ASSERT_EQ(found.positions.size(), 12u);
  EXPECT_LT(error_px(found.positions, found.truth), 0.1);
  const auto c = calibrate(small_board(), 512, 512, 1, found.positions);
  EXPECT_LT(c.rms_px, 0.1);
  EXPECT_FALSE(c.free_board);
  expect_camera_within(c, 4.5);
}

TEST(BoardDetection, CirclePicturesGiveTheCameraWhenTheirPerspectiveIsTakenOut) {
  Board board = small_board(BoardKind::CIRCLES);
  board.disc_m = 0.6 * board.pitch_m;
  const auto found = find_all(board, 0.7, 2, 12);
  ASSERT_EQ(found.positions.size(), 12u);
  for (const double ratio : found.disc_ratios) EXPECT_NEAR(ratio, 0.6, 0.03);
  const auto c = calibrate(board, 512, 512, 1, found.positions);
  EXPECT_LT(c.rms_px, 0.1);
  expect_camera_within(c, 4.5);
  const double before = error_px(found.positions, found.truth), after = error_px(c.positions, found.truth);
  EXPECT_LT(after, 0.03);
  EXPECT_LT(after, 0.7 * before);
}

TEST(BoardDetection, LightCirclesOnDarkAreFound) {
  Board board = small_board(BoardKind::CIRCLES);
  board.disc_m = 0.6 * board.pitch_m;
  const test::BoardPainter painter(table2_camera());
  auto random = test::seeded();
  const auto T = test::board_poses(random, table2_camera(), board, 1)[0];
  const cv::Mat picture = 255 - painter.paint(board, T, 1, random);
  const auto detection = detect_board(picture, board);
  ASSERT_EQ(detection.problem, "");
  Corners truth;
  for (const auto& p : board.points()) truth.push_back(table2_camera().project(T * p));
  const auto corners =
      reordered(detection.corners, same_looking_orders(board)[order_like(board, detection.corners, truth)]);
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_LT((corners[i] - truth[i]).norm(), 0.25) << i;
}

}  // namespace
}  // namespace heartservo::tracking
