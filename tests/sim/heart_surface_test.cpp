#include "sim/heart/heart_surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/random.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

HeartSurface surface(const HeartSurfaceOptions& options = {}, const char* profile = "sharp") {
  HeartMotionOptions motion;
  motion.profile = profile;
  return HeartSurface(options, HeartMotion(motion, 5, 20), 6);
}

HeartSurfaceOptions with_landmarks() {
  HeartSurfaceOptions options;
  options.landmarks = {{.x_m = 0.002, .y_m = 0.001, .side_m = 0.005, .angle_rad = 0.3}, {.x_m = -0.013, .y_m = -0.004}};
  return options;
}

TEST(SineCosine, AgreesWithTheLibrary) {
  for (double x = -40; x < 40; x += 0.0137) {
    double s, c;
    sine_cosine(x, s, c);
    EXPECT_NEAR(s, std::sin(x), 1e-9);
    EXPECT_NEAR(c, std::cos(x), 1e-9);
  }
}

TEST(HeartSurface, DerivativesAreThoseOfThePoint) {
  const SurfaceState state = surface(with_landmarks()).at(1.234);
  auto random = test::seeded();
  for (int i = 0; i < 300; ++i) {  // on the plates, in their blend and on free tissue
    const Eigen::Vector2d ab(test::uniform(random, -0.02, 0.012), test::uniform(random, -0.012, 0.012));
    const auto position = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
      const SurfacePoint p = surface_point(state, x(0), x(1));
      return Eigen::Vector3d(p.x, p.y, p.z);
    };
    const SurfacePoint p = surface_point(state, ab.x(), ab.y());
    Eigen::Matrix<double, 3, 2> J;
    J << p.xa, p.xb, p.ya, p.yb, p.za, p.zb;
    EXPECT_LT((test::numeric_jacobian(position, ab) - J).norm(), 1e-5) << ab.transpose();
  }
}

TEST(HeartSurface, PlatesAreRigidAndPlanar) {
  const HeartSurface heart = surface(with_landmarks());
  auto random = test::seeded();
  for (std::size_t k = 0; k < heart.landmark_count(); ++k) {
    const LandmarkOptions& landmark = heart.options().landmarks[k];
    for (int i = 0; i < 100; ++i) {
      const double t = test::uniform(random, 0, 20), h = landmark.side_m / 2;
      const Eigen::Vector2d pq(test::uniform(random, -h, h), test::uniform(random, -h, h));
      const Eigen::Vector2d ab =
          Eigen::Vector2d(landmark.x_m, landmark.y_m) + Eigen::Rotation2Dd(landmark.angle_rad) * pq;
      const Eigen::Vector3d expected = heart.T_camera_landmark(k, t) * Eigen::Vector3d(pq.x(), pq.y(), 0);
      EXPECT_LT((heart.point(ab.x(), ab.y(), t) - expected).norm(), 1e-12);
    }
  }
}

TEST(HeartSurface, LandmarkFrameLooksAwayFromTheCamera) {
  const HeartSurface heart = surface(with_landmarks(), "still");
  const Eigen::Isometry3d T = heart.T_camera_landmark(1, 0);
  EXPECT_GT(T.linear()(0, 0), 0.9);
  EXPECT_GT(T.linear()(1, 1), 0.9);
  EXPECT_GT(T.linear()(2, 2), 0.9);
  EXPECT_NEAR((T.linear().transpose() * T.linear() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
  const auto corners = heart.landmark_corners(1, 0);
  EXPECT_LT(corners[0].x(), corners[1].x());
  EXPECT_LT(corners[1].y(), corners[2].y());
  EXPECT_NEAR((corners[2] - corners[1]).norm(), 0.005, 1e-12);
}

TEST(HeartSurface, TissueStrainsByAboutTheStatedAmount) {
  const HeartSurface heart = surface();
  double largest = 0;
  for (double t = 0; t < 3; t += 0.05) {
    const SurfaceState state = heart.at(t);
    for (double b = -0.024; b <= 0.024; b += 0.003)
      for (double a = -0.024; a <= 0.024; a += 0.003) {
        const SurfacePoint p = tissue_point(state.tissue, a, b);
        Eigen::Matrix2d J;  // in the sheet only: strain of the projection on the plane z = 0
        J << p.xa, p.xb, p.ya, p.yb;
        largest = std::max(largest, Eigen::JacobiSVD<Eigen::Matrix2d>(J).singularValues()(0) - 1);
      }
  }
  EXPECT_GT(largest, 0.035);
  EXPECT_LT(largest, 0.065);
}

TEST(HeartSurface, DistancesOnTissueChangeUnlessDeformationIsOff) {
  HeartSurfaceOptions rigid;
  rigid.strain = rigid.bulge_m = 0;
  const HeartSurface stiff = surface(rigid), soft = surface();
  auto range = [](const HeartSurface& heart) {
    double low = 1, high = 0;
    for (double t = 0; t < 2; t += 0.02) {
      const double d = (heart.point(0.006, 0.008, t) - heart.point(-0.001, 0.006, t)).norm();
      low = std::min(low, d), high = std::max(high, d);
    }
    return (high - low) / low;
  };
  EXPECT_LT(range(stiff), 1e-12);
  EXPECT_GT(range(soft), 0.01);
}

TEST(HeartSurface, PointFrameOnAPlateIsThePlatesFrame) {
  const HeartSurface heart = surface(with_landmarks());
  const Eigen::Isometry3d plate = heart.T_camera_landmark(1, 2.2), point = heart.T_camera_point(-0.012, -0.0035, 2.2);
  EXPECT_LT((plate.linear() - point.linear()).norm(), 1e-9);
  EXPECT_LT((plate * Eigen::Vector3d(0.001, 0.0005, 0) - point.translation()).norm(), 1e-12);
}

TEST(HeartSurface, AnchorMovesAsTheMotionSays) {
  HeartSurfaceOptions rigid;
  rigid.strain = rigid.bulge_m = 0;
  const HeartSurface heart = surface(rigid);
  for (const double t : {0.2, 3.1, 8.8})
    EXPECT_LT((heart.point(0, 0, t) - rigid.anchor_m - heart.motion().displacement(t)).norm(), 1e-12);
}

TEST(HeartSurface, RefusesLandmarksThatReachIntoEachOther) {
  HeartSurfaceOptions options;
  options.landmarks = {{.x_m = 0}, {.x_m = 0.008}};
  EXPECT_THROW(surface(options), ConfigError);
}

}  // namespace
}  // namespace heartservo::sim
