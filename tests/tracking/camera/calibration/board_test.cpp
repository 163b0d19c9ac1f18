#include "tracking/camera/calibration/board.hpp"

#include <gtest/gtest.h>

#include "tests/support/board_scene.hpp"
#include "tests/support/table2_camera.hpp"
#include "tracking/camera/calibration/board_detection.hpp"
#include "tracking/camera/calibration/disc_offset.hpp"
#include "tracking/camera/calibration/plane_homography.hpp"

namespace heartservo::tracking {
namespace {

using test::small_board;
using test::table2_camera;

class GridProblem : public testing::Test {
 protected:
  Corners view(double tilt = 0.5) {
    return test::board_corners(random_, table2_camera(), small_board().points(),
                               test::board_pose({0.001, -0.001, 0.055}, tilt, 0.8, 0.3), 0.1);
  }
  static void expect(const Corners& corners, const std::string& part) {
    EXPECT_NE(grid_problem(small_board(), corners).find(part), std::string::npos)
        << grid_problem(small_board(), corners);
  }

  std::mt19937_64 random_ = test::seeded();
};

TEST_F(GridProblem, AGoodViewHasNone) {
  for (const double tilt : {0.0, 0.3, 0.8, 1.1}) EXPECT_EQ(grid_problem(small_board(), view(tilt)), "");
}

TEST_F(GridProblem, MirroredOrderIsNamed) {
  Corners rows = view(), columns = view();
  for (int r = 0; r < 7; ++r) std::reverse(rows.begin() + 9 * r, rows.begin() + 9 * (r + 1));
  expect(rows, "mirrored");
  for (int r = 0; r < 3; ++r)
    std::swap_ranges(columns.begin() + 9 * r, columns.begin() + 9 * (r + 1), columns.begin() + 9 * (6 - r));
  expect(columns, "mirrored");
  Corners turned = view();
  std::reverse(turned.begin(), turned.end());
  EXPECT_EQ(grid_problem(small_board(), turned), "") << "the board turned by 180 degrees is a board";
}

TEST_F(GridProblem, SwappedNumbersAreNamed) {
  Board swapped = small_board();
  std::swap(swapped.columns, swapped.rows);
  const std::string problem = grid_problem(swapped, view());
  EXPECT_NE(problem.find("--columns 9 --rows 7"), std::string::npos) << problem;
}

TEST_F(GridProblem, OtherDisordersAreNamed) {
  Corners few = view();
  few.pop_back();
  expect(few, "62 corners, a board of 9 x 7 has 63");
  Corners lost = view();
  lost[5].x() = NAN;
  expect(lost, "corner 6 is not finite");
  Corners twice = view();
  twice[8] = twice[9];
  expect(twice, "apart");
  Corners shuffled = view();
  std::shuffle(shuffled.begin(), shuffled.end(), random_);
  expect(shuffled, "no grid");
  Corners line;
  for (int i = 0; i < 63; ++i) line.emplace_back(5.0 * i, 100);
  expect(line, "from its edge");
}

TEST(Board, OrdersThatLookTheSameAreThoseOfATurnedBoard) {
  Board board{BoardKind::CIRCLES, 3, 2, 0.01, 0};
  const auto orders = same_looking_orders(board);
  ASSERT_EQ(orders.size(), 2u);
  EXPECT_EQ(orders[1], (std::vector<std::size_t>{5, 4, 3, 2, 1, 0}));
  board.rows = 3;
  const auto square = same_looking_orders(board);
  ASSERT_EQ(square.size(), 4u);
  const auto points = board.points();
  Corners corners;
  for (const auto& p : points) corners.emplace_back(100 + 1000 * p.x(), 100 + 1000 * p.y());
  for (const auto& order : square) {
    EXPECT_EQ(grid_problem(board, reordered(corners, order)), "") << "turned, not mirrored";
    EXPECT_EQ(reordered(reordered(corners, order), square[order_like(board, reordered(corners, order), corners)]),
              corners);
  }
}

TEST(PlaneHomography, ExactWithoutNoiseAndNothingForALine) {
  auto random = test::seeded();
  const auto points = small_board().points();
  Camera pinhole = table2_camera();
  pinhole.k1 = pinhole.k2 = pinhole.k3 = pinhole.k4 = 0;
  const auto T = test::board_pose({0.002, 0.003, 0.06}, 0.6, 1.2, 0.5);
  const auto H = plane_homography(points, test::board_corners(random, pinhole, points, T, 0));
  ASSERT_TRUE(H);
  for (const auto& p : points)
    EXPECT_LT(((*H * Eigen::Vector3d(p.x(), p.y(), 1)).hnormalized() - pinhole.project(T * p)).norm(), 1e-8);
  std::vector<Eigen::Vector3d> line;
  Corners images;
  for (int i = 0; i < 8; ++i) {
    line.emplace_back(0.001 * i, 0.002 * i, 0);
    images.emplace_back(30 * i, 50 * i);
  }
  EXPECT_FALSE(plane_homography(line, images));
}

TEST(PlaneHomography, FocalLengthAndPosesOfAPinhole) {
  auto random = test::seeded();
  const Camera camera = Camera::pinhole(640, 480, 0.8);
  const auto points = small_board().points();
  std::vector<Eigen::Matrix3d> homographies;
  for (const auto& T : test::board_poses(random, camera, small_board(), 4)) {
    const auto corners = test::board_corners(random, camera, points, T, 0);
    homographies.push_back(*plane_homography(points, corners));
    const auto pose = plane_pose(camera, points, corners);
    ASSERT_TRUE(pose);
    EXPECT_LT((pose->matrix() - T.matrix()).norm(), 1e-8);
  }
  EXPECT_NEAR(focal_length(homographies, 640, 480).value(), camera.fx, 1e-6);
  const auto facing = test::board_corners(random, camera, points, test::board_pose({0, 0, 0.06}, 0, 0, 0), 0);
  EXPECT_FALSE(focal_length({*plane_homography(points, facing)}, 640, 480));
}

// Against the sum over a fine mesh of the disc's picture.
TEST(DiscOffset, IsThatOfTheCentreOfGravity) {
  const auto T = test::board_pose({0.008, -0.006, 0.05}, 0.7, 0.4, 0.2);
  const Eigen::Vector3d centre(0.005, -0.0025, 0);
  const double diameter = 0.004;
  const Camera camera = table2_camera();
  std::vector<Eigen::Vector2d> outline;
  for (int k = 0; k < 20000; ++k) {
    const double angle = 2 * M_PI * k / 20000;
    outline.push_back(
        camera.project(T * (centre + diameter / 2 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0))));
  }
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();  // of the polygon (shoelace), about the first point
  double area = 0;
  const Eigen::Vector2d origin = outline[0];
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d a = outline[k] - origin, b = outline[(k + 1) % outline.size()] - origin;
    const double w = a.x() * b.y() - a.y() * b.x();
    area += w / 2;
    moment += w / 6 * (a + b);
  }
  const Eigen::Vector2d expected = origin + moment / area - camera.project(T * centre);
  EXPECT_GT(expected.norm(), 0.2) << "worth correcting";
  EXPECT_LT((disc_offset(camera, T, centre, diameter) - expected).norm(), 2e-3);
}

TEST(BoardDetection, PicturesWithoutABoardAreRefusedWithAReason) {
  const auto problem = [](const cv::Mat& grey, BoardKind kind = BoardKind::CHESSBOARD) {
    const auto found = detect_board(grey, small_board(kind));
    EXPECT_TRUE(found.corners.empty());
    return found.problem;
  };
  EXPECT_EQ(problem(cv::Mat(200, 200, CV_8UC1, cv::Scalar(3))), "the picture is dark");
  EXPECT_EQ(problem(cv::Mat(200, 200, CV_8UC1, cv::Scalar(252))), "the picture is overexposed");
  EXPECT_EQ(problem(cv::Mat(200, 200, CV_8UC1, cv::Scalar(120))), "the picture has no contrast");
  auto random = test::seeded();
  cv::Mat noise(200, 200, CV_8UC1);
  for (auto& g : cv::Mat_<std::uint8_t>(noise)) g = static_cast<std::uint8_t>(test::uniform(random, 0, 255));
  EXPECT_NE(problem(noise).find("no chessboard of 9 x 7 inner corners found"), std::string::npos);
  EXPECT_NE(problem(noise, BoardKind::CIRCLES).find("no board of 9 x 7 circles found"), std::string::npos);
  EXPECT_NE(problem(cv::Mat(1, 1, CV_8UC1, cv::Scalar(100))), "");
}

}  // namespace
}  // namespace heartservo::tracking
