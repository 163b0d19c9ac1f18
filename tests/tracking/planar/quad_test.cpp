#include "tracking/planar/quad.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>
#include <utility>

#include "tests/support/random.hpp"

namespace heartservo::tracking {
namespace {

Quad random_quad(std::mt19937_64& random) {
  Quad quad = rectangle(100, 50, 60, 40);
  for (auto& corner : quad) corner += Eigen::Vector2d(test::uniform(random, -12, 12), test::uniform(random, -12, 12));
  return quad;
}

TEST(Quad, AreaIsSignedByTheSenseOfRotation) {
  const Quad quad = rectangle(10, 20, 30, 40);
  EXPECT_DOUBLE_EQ(area(quad), 1200);
  EXPECT_DOUBLE_EQ(area({quad[3], quad[2], quad[1], quad[0]}), -1200);
  EXPECT_DOUBLE_EQ(area({Eigen::Vector2d(0, 0), {4, 0}, {5, 3}, {0, 2}}), 11);
}

TEST(Quad, ConvexMeansClockwiseFiniteAndWithoutDent) {
  const Quad quad = rectangle(10, 20, 30, 40);
  EXPECT_TRUE(is_convex(quad));
  EXPECT_FALSE(is_convex({quad[3], quad[2], quad[1], quad[0]})) << "anticlockwise";
  EXPECT_FALSE(is_convex({quad[0], quad[2], quad[1], quad[3]})) << "bow tie";
  EXPECT_FALSE(is_convex({quad[0], quad[1], Eigen::Vector2d(12, 22), quad[3]})) << "dent";
  EXPECT_FALSE(is_convex({quad[0], quad[0], quad[2], quad[3]})) << "two corners in one";
  Quad broken = quad;
  broken[2].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_convex(broken));
  broken[2].x() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(is_convex(broken));
}

TEST(Quad, HomographyTakesCornersToCorners) {
  auto random = test::seeded();
  for (int trial = 0; trial < 200; ++trial) {
    const Quad from = random_quad(random), to = random_quad(random);
    const Eigen::Matrix3d H = homography_between(from, to);
    EXPECT_DOUBLE_EQ(H(2, 2), 1);
    const Quad moved = transform(H, from);
    for (int i = 0; i < 4; ++i) EXPECT_LT((moved[i] - to[i]).norm(), 1e-10);
  }
}

TEST(Quad, HomographyIsTheOneThatMadeTheCorners) {
  Eigen::Matrix3d H;
  H << 1.1, 0.05, 12, -0.08, 0.95, -7, 2e-4, -1e-4, 1;
  const Quad from = rectangle(200, 150, 80, 60);
  EXPECT_LT((homography_between(from, transform(H, from)) - H).norm(), 1e-10);
}

TEST(Quad, HomographyIsAsGoodInMillimetresOfAMetreAsInPixels) {
  const Quad metres = rectangle(-0.0025, -0.0025, 0.005, 0.005), pixels = rectangle(250, 240, 54, 54);
  const Quad there = transform(homography_between(metres, pixels), metres);
  for (int i = 0; i < 4; ++i) EXPECT_LT((there[i] - pixels[i]).norm(), 1e-10);
  const Quad back = transform(homography_between(pixels, metres), pixels);
  for (int i = 0; i < 4; ++i) EXPECT_LT((back[i] - metres[i]).norm(), 1e-15);
}

TEST(Quad, HomographyOfCornersOnALineIsNotFiniteOrNotInvertible) {
  const Quad line{Eigen::Vector2d(0, 0), {1, 1}, {2, 2}, {3, 3}};
  const Eigen::Matrix3d H = homography_between(line, rectangle(0, 0, 1, 1));
  EXPECT_TRUE(!H.allFinite() || std::abs(H.determinant()) < 1e-9 || H.norm() > 1e9);
}

}  // namespace
}  // namespace heartservo::tracking
