#include "tracking/camera/calibration/board_equations.hpp"

#include <gtest/gtest.h>

#include "tests/support/board_scene.hpp"
#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/table2_camera.hpp"

namespace heartservo::tracking {
namespace {

using test::small_board;
using test::table2_camera;

// Both cameras, three positions, one of them seen by the right side only; a corner is left out.
class BoardEquationsOfAPair : public testing::Test {
 protected:
  BoardEquationsOfAPair() {
    rig_.cameras = {table2_camera(), table2_camera()};
    rig_.cameras[1].fx = 610;
    rig_.T_right_left.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d(0.2, 1, 0.3).normalized()).matrix();
    rig_.T_right_left.translation() << -0.005, 0.001, 0.0005;
    rig_.points = small_board().points();
    for (const auto& T : test::board_poses(random_, table2_camera(), small_board(), 3)) {
      rig_.T_left_board.push_back(T);
      positions_.push_back({{"", ""},
                            {test::board_corners(random_, rig_.cameras[0], rig_.points, T, 1),
                             test::board_corners(random_, rig_.cameras[1], rig_.points, rig_.T_right_left * T, 1)}});
    }
    positions_[1].corners[0].clear();
    positions_[2].corners[1][7].setConstant(NAN);
  }

  std::mt19937_64 random_ = test::seeded();
  BoardRig rig_;
  std::vector<BoardPosition> positions_;
};

// The right-hand sides are minus half the gradient of the sum of squares, for every kind of unknown.
TEST_F(BoardEquationsOfAPair, AreTheGradientOfTheSumOfSquares) {
  BoardEquations problem(rig_, positions_, {true, true});
  for (auto& p : rig_.points) p += 1e-5 * Eigen::Vector3d(1, -2, 3);  // off the gauge, too
  const auto n = problem.at(rig_);
  const int shared = problem.unknowns().size, all = shared + 18;
  EXPECT_EQ(shared, 22 + 3 * 63);
  EXPECT_EQ(problem.degrees_of_freedom(), 2 * (5 * 63 - 1) - all + 7);
  const auto cost = [&](const Eigen::VectorXd& x) {
    std::vector<Vector6> poses;
    for (int p = 0; p < 3; ++p) poses.push_back(x.segment<6>(shared + 6 * p));
    const BoardRig moved = problem.stepped(rig_, x.head(shared), poses);
    return Eigen::VectorXd(Eigen::VectorXd::Constant(1, problem.cost(moved) + problem.gauge_cost(moved)));
  };
  Eigen::VectorXd expected(all);
  expected << n.g, n.e[0], n.e[1], n.e[2];
  for (int k = 0; k < all; ++k) {
    const double scale = k < shared ? n.A(k, k) : n.D[(k - shared) / 6]((k - shared) % 6, (k - shared) % 6);
    const double step = 1e-3 / std::sqrt(scale);
    Eigen::VectorXd up = Eigen::VectorXd::Zero(all), down = up;
    up[k] = step;
    down[k] = -step;
    const double slope = (cost(up)[0] - cost(down)[0]) / (2 * step);
    EXPECT_NEAR(-0.5 * slope / std::sqrt(scale), expected[k] / std::sqrt(scale), 1e-4) << k;
  }
}

TEST_F(BoardEquationsOfAPair, APointBehindACameraCostsInfinitely) {
  BoardEquations problem(rig_, positions_, {});
  rig_.T_left_board[0].translation().z() = 0.001;
  EXPECT_EQ(problem.cost(rig_), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(adjust_board_rig(rig_, positions_, {}).converged);
}

// Leaving a pose to the last by the Schur complement gives what solving everything at once gives.
TEST_F(BoardEquationsOfAPair, InverseInformationIsABlockOfTheWholeInverse) {
  const auto adjusted = adjust_board_rig(rig_, positions_, {true, false});
  EXPECT_TRUE(adjusted.converged);
  BoardEquations problem(adjusted.rig, positions_, {true, false});
  const auto n = problem.at(adjusted.rig);
  const int shared = problem.unknowns().size;
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(shared + 18, shared + 18);
  whole.topLeftCorner(shared, shared) = n.A;
  for (int p = 0; p < 3; ++p) {
    whole.block(0, shared + 6 * p, shared, 6) = n.B[p];
    whole.block(shared + 6 * p, 0, 6, shared) = n.B[p].transpose();
    whole.block<6, 6>(shared + 6 * p, shared + 6 * p) = n.D[p];
  }
  const Eigen::VectorXd scale = whole.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inverse =
      scale.asDiagonal() * (scale.asDiagonal() * whole * scale.asDiagonal()).inverse() * scale.asDiagonal();
  for (int i = 0; i < shared; ++i)
    for (int j = 0; j < shared; ++j) {
      const double unit = std::sqrt(inverse(i, i) * inverse(j, j));
      EXPECT_NEAR(adjusted.inverse_information(i, j) / unit, inverse(i, j) / unit, 1e-5) << i << " " << j;
    }
}

}  // namespace
}  // namespace heartservo::tracking
