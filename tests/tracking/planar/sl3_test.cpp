#include "tracking/planar/sl3.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/random.hpp"

namespace heartservo::tracking {
namespace {

Vector8d random_algebra(std::mt19937_64& random, double size) {
  Vector8d d;
  for (int i = 0; i < 8; ++i) d[i] = test::uniform(random, -size, size);
  return d;
}

TEST(Sl3, ExponentialHasDeterminantOneAndInvertsByMinus) {
  auto random = test::seeded();
  for (int i = 0; i < 200; ++i) {
    const Vector8d d = random_algebra(random, 1.5);
    EXPECT_NEAR(sl3_exp(d).determinant(), 1, 1e-11);
    EXPECT_LT((sl3_exp(d) * sl3_exp(-d) - Eigen::Matrix3d::Identity()).norm(), 1e-10);
  }
}

TEST(Sl3, ExponentialOfOneDirectionIsAOneParameterGroup) {
  auto random = test::seeded();
  const Vector8d d = random_algebra(random, 1);
  EXPECT_LT((sl3_exp(0.3 * d) * sl3_exp(0.7 * d) - sl3_exp(d)).norm(), 1e-13);
}

TEST(Sl3, PointJacobianAgreesWithCentralDifferences) {
  auto random = test::seeded();
  for (int i = 0; i < 20; ++i) {
    const double x = test::uniform(random, -1, 1), y = test::uniform(random, -1, 1);
    const auto move = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
      return (sl3_exp(d) * Eigen::Vector3d(x, y, 1)).hnormalized();
    };
    const Eigen::MatrixXd J = test::numeric_jacobian(move, Eigen::VectorXd::Zero(8));
    EXPECT_LT((J - sl3_point_jacobian(x, y)).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(Sl3, NotFiniteStaysNotFinite) {
  Vector8d d = Vector8d::Zero();
  d[3] = std::nan("");
  EXPECT_FALSE(sl3_exp(d).allFinite());
}

}  // namespace
}  // namespace heartservo::tracking
