#include "tracking/planar/spline_bend.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/random.hpp"
#include "tracking/planar/bent_grid.hpp"

namespace heartservo::tracking {
namespace {

const SplineBend kBend(1, 0.75, 0.3);

BendField random_field(std::mt19937_64& random, double size) {
  BendField field(3, kBend.points());
  for (int i = 0; i < field.cols(); ++i)
    for (int part = 0; part < 3; ++part) field(part, i) = test::normal(random, size);
  return field;
}

// The control points that move the patch by `map`, which has to be quadratic at most.
template <class Map>
BendField field_of(const Map& map) {
  BendField field(3, kBend.points());
  for (int row = 0; row < kBend.rows(); ++row)
    for (int column = 0; column < kBend.columns(); ++column)
      field.col(row * kBend.columns() + column) << map(kBend.rest(column, row)) - kBend.rest(column, row), 0;
  return field;
}

Eigen::Vector2d random_point(std::mt19937_64& random) {
  return {test::uniform(random, -1, 1), test::uniform(random, -0.75, 0.75)};
}

TEST(SplineBend, MovesThePatchAsItsControlPointsWhereTheyMoveAffinely) {
  auto random = test::seeded();
  Eigen::Matrix2d A;
  A << 1.1, -0.2, 0.15, 0.9;
  const Eigen::Vector2d t(0.05, -0.08);
  const auto affine = [&](const Eigen::Vector2d& x) -> Eigen::Vector2d { return A * x + t; };
  const BendField field = field_of(affine);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d x = random_point(random);
    EXPECT_LT((x + kBend.offset(field, x) - affine(x)).norm(), 1e-12);
  }
}

TEST(SplineBend, IsContinuousAcrossCells) {
  auto random = test::seeded();
  const BendField field = random_field(random, 0.1);
  for (double x = -1; x < 1; x += 0.001) {
    EXPECT_LT((kBend.offset(field, {x, 0.2}) - kBend.offset(field, {x + 1e-9, 0.2})).norm(), 1e-7);
    EXPECT_NEAR(kBend.gain_offset(field, {x, 0.2}), kBend.gain_offset(field, {x + 1e-9, 0.2}), 1e-7);
  }
}

TEST(SplineBend, HasNoMoreControlPointsThanABendFieldHolds) {
  EXPECT_LE(SplineBend(1, 1, 0.01).points(), kMaxBendPoints);
  EXPECT_LE(SplineBend(1, 0.1, 0.01).points(), kMaxBendPoints);
  EXPECT_EQ(SplineBend(1, 1, 5).points(), 9);
}

TEST(SplineBend, DifferencesOfAffineMapsAreZero) {
  const BendField field = field_of([](const Eigen::Vector2d& x) -> Eigen::Vector2d {
    return {1.2 * x.x() + 0.1 * x.y() + 0.3, 0.2 * x.x() - x.y()};
  });
  BendField bent = field;
  bent(0, kBend.points() / 2) += 0.1;
  double most = 0;
  for (const auto& d : kBend.differences()) {
    Eigen::Vector3d plain = Eigen::Vector3d::Zero(), value = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      plain += d.factor[i] * field.col(d.point[i]);
      value += d.factor[i] * bent.col(d.point[i]);
    }
    EXPECT_LT(plain.norm(), 1e-12);
    most = std::max(most, value.norm());
  }
  EXPECT_NEAR(most, 0.2, 1e-12);  // 1, -2, 1
}

TEST(SplineBend, SplitsIntoAHomographyAndABendThatLeavesTheCentreInPlace) {
  auto random = test::seeded();
  for (int trial = 0; trial < 20; ++trial) {
    const BendField before = random_field(random, 0.01);
    BendField after = before;
    const Eigen::Matrix3d H = kBend.split_homography(after);
    EXPECT_LT(kBend.offset(after, {0, 0}).norm(), 1e-12);
    EXPECT_EQ(before.row(2), after.row(2));  // the light is the template's, wherever it lies
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d x = random_point(random), bent = x + kBend.offset(after, x);
      const Eigen::Vector2d found = (H * bent.homogeneous()).hnormalized();
      EXPECT_LT((found - x - kBend.offset(before, x)).norm(), 1e-3);  // third-order terms of the perspective
    }
  }
}

TEST(SplineBend, AHomographyLeavesNoBend) {
  const Eigen::Vector2d p(0.004, -0.006);
  Eigen::Matrix2d A;
  A << 1.02, 0.03, -0.02, 0.98;
  BendField field(3, kBend.points());
  const double xx = kBend.cell_x() * kBend.cell_x() / 4, yy = kBend.cell_y() * kBend.cell_y() / 4;
  for (int row = 0; row < kBend.rows(); ++row)
    for (int column = 0; column < kBend.columns(); ++column) {
      const Eigen::Vector2d r = kBend.rest(column, row);
      // control points of -(p . x) x: those of x^2 are r^2 - cell^2 / 4
      const Eigen::Vector2d q(-(p.x() * (r.x() * r.x() - xx) + p.y() * r.x() * r.y()),
                              -(p.x() * r.x() * r.y() + p.y() * (r.y() * r.y() - yy)));
      field.col(row * kBend.columns() + column) << A * (r + q) - r + Eigen::Vector2d(0.01, 0.02), 0;
    }
  const Eigen::Matrix3d H = kBend.split_homography(field);
  EXPECT_LT(field.cwiseAbs().maxCoeff(), 1e-5);  // a thousandth of a pixel
  EXPECT_NEAR(H(2, 0), p.x(), 1e-5);
  EXPECT_NEAR(H(2, 1), p.y(), 1e-5);
}

TEST(BentGrid, IsTheBendAtEveryPointOfThePatch) {
  auto random = test::seeded();
  Patch patch;
  patch.width = 41, patch.height = 31, patch.step = 0.05F;
  patch.grey.resize(41 * 31);
  const BendField field = random_field(random, 0.05);
  BentGrid grid(kBend, patch);
  const BentPoints bent = grid.bend(field);
  for (int row = 0; row < patch.height; ++row)
    for (int column = 0; column < patch.width; ++column) {
      const Eigen::Vector2d x(patch.x_of(column), patch.y_of(row)), wanted = x + kBend.offset(field, x);
      const int i = row * patch.width + column;
      ASSERT_NEAR(bent.x[i], wanted.x(), 1e-6);
      ASSERT_NEAR(bent.y[i], wanted.y(), 1e-6);
      ASSERT_NEAR(bent.gain_offset[i], kBend.gain_offset(field, x), 1e-6);
    }
}

}  // namespace
}  // namespace heartservo::tracking
