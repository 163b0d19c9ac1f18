#include "tracking/depth/surface_model.hpp"

#include <gtest/gtest.h>

#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/random.hpp"

namespace heartservo::tracking {
namespace {

SurfaceModel grid_model() {
  std::vector<Eigen::Vector2d> rays;
  for (int i = 0; i < 9; ++i) rays.emplace_back(0.05 + 0.12 * (i % 3 - 1), -0.03 + 0.12 * (i / 3 - 1));
  return {rays, {0.05, -0.03}};
}

SurfaceShape some_shape() { return (SurfaceShape() << 0.2, -0.15, 1.1, 0.2, 0.8).finished(); }

struct View {
  Eigen::VectorXd seen = Eigen::VectorXd(18);
  Eigen::MatrixXd J_pose = Eigen::MatrixXd(18, 6), J_shape = Eigen::MatrixXd(18, 5);
  bool good = false;
};

View view_of(const SurfaceModel& model, const SurfacePose& pose, const SurfaceShape& shape) {
  View v;
  v.good = model.view(pose, shape, v.seen, v.J_pose, v.J_shape);
  return v;
}

TEST(SurfaceModel, PointsLieOnTheirRaysAndOnTheSurface) {
  const SurfaceModel model = grid_model();
  const SurfaceShape s = some_shape();
  for (std::size_t i = 0; i < 9; ++i) {
    const Eigen::Vector3d p = model.point(s, i), from_camera = p + model.centre().homogeneous();
    EXPECT_LT((from_camera.hnormalized() - model.rays()[i]).norm(), 1e-12);
    const double z = s[0] * p.x() + s[1] * p.y() + 0.5 * s[2] * p.x() * p.x() + s[3] * p.x() * p.y() +
                     0.5 * s[4] * p.y() * p.y();
    EXPECT_NEAR(p.z(), z, 1e-12);
  }
}

TEST(SurfaceModel, ThePoseOfTheFirstFrameShowsTheFirstView) {
  const SurfaceModel model = grid_model();
  const View v = view_of(model, {model.centre().homogeneous(), Eigen::Matrix3d::Identity()}, some_shape());
  ASSERT_TRUE(v.good);
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_LT((v.seen.segment<2>(2 * static_cast<Eigen::Index>(i)) - model.rays()[i]).norm(), 1e-12);
}

TEST(SurfaceModel, JacobiansAgreeWithCentralDifferences) {
  const SurfaceModel model = grid_model();
  auto random = test::seeded();
  for (int round = 0; round < 5; ++round) {
    Eigen::Matrix<double, 6, 1> twist;
    for (double& v : twist) v = test::uniform(random, -0.15, 0.15);
    const SurfacePose pose = moved({model.centre().homogeneous(), Eigen::Matrix3d::Identity()}, twist);
    const View v = view_of(model, pose, some_shape());
    const auto by_pose = test::numeric_jacobian(
        [&](const Eigen::VectorXd& x) {
          return view_of(model, moved(pose, Eigen::Matrix<double, 6, 1>(x)), some_shape()).seen;
        },
        Eigen::VectorXd::Zero(6));
    const auto by_shape = test::numeric_jacobian(
        [&](const Eigen::VectorXd& x) { return view_of(model, pose, some_shape() + x).seen; },
        Eigen::VectorXd::Zero(5));
    EXPECT_LT((v.J_pose - by_pose).cwiseAbs().maxCoeff(), 1e-8);
    EXPECT_LT((v.J_shape - by_shape).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(SurfaceModel, APointBehindTheCameraIsNoView) {
  const SurfaceModel model = grid_model();
  EXPECT_FALSE(view_of(model, {{0, 0, -0.1}, Eigen::Matrix3d::Identity()}, SurfaceShape::Zero()).good);
}

}  // namespace
}  // namespace heartservo::tracking
