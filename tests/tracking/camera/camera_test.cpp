#include "tracking/camera/camera.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/calib3d.hpp>

#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/random.hpp"
#include "tests/support/table2_camera.hpp"

namespace heartservo::tracking {
namespace {

using test::table2_camera;

bool mentions(const std::vector<std::string>& problems, const std::string& word) {
  for (const auto& problem : problems)
    if (problem.find(word) != std::string::npos) return true;
  return false;
}

TEST(Camera, DistortsAsEquations3And4ArePrinted) {
  const Camera camera = table2_camera();
  auto random = test::seeded();
  for (int i = 0; i < 100; ++i) {
    const double xn = test::uniform(random, -0.5, 0.5), yn = test::uniform(random, -0.5, 0.5);
    const double r = std::sqrt(xn * xn + yn * yn);
    const double k1 = -0.241, k2 = 0.207, k3 = 0.005, k4 = 0.008;
    const double dx = 2 * k3 * xn * yn + k4 * (std::pow(r, 2) + 2 * std::pow(xn, 2));
    const double dy = k3 * (std::pow(r, 2) + 2 * std::pow(yn, 2)) + 2 * k4 * xn * yn;
    const double xd = (1 + k1 * std::pow(r, 2) + k2 * std::pow(r, 4)) * xn + dx;
    const double yd = (1 + k1 * std::pow(r, 2) + k2 * std::pow(r, 4)) * yn + dy;
    EXPECT_LT((camera.distort({xn, yn}) - Eigen::Vector2d(xd, yd)).norm(), 1e-15);
    const Eigen::Vector2d pixel = camera.project({xn * 0.055, yn * 0.055, 0.055});
    EXPECT_NEAR(pixel.x(), 593.6 * xd + 279.6, 1e-10);
    EXPECT_NEAR(pixel.y(), 594.5 * yd + 223.7, 1e-10);
  }
}

TEST(Camera, DistortJacobianIsTheDerivative) {
  const Camera camera = table2_camera();
  auto random = test::seeded();
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector2d x(test::uniform(random, -0.6, 0.6), test::uniform(random, -0.6, 0.6));
    const Eigen::MatrixXd J = test::numeric_jacobian(
        [&](const Eigen::VectorXd& p) -> Eigen::VectorXd { return camera.distort(p.head<2>()); }, x);
    EXPECT_LT((camera.distort_jacobian(x) - J).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(Camera, UndistortInvertsOverEveryPixelAndBeyondTheBorder) {
  const Camera camera = table2_camera();
  double worst_pixel_side = 0, worst_normalised_side = 0;
  for (int v = -51; v <= 563; ++v)
    for (int u = -51; u <= 563; ++u) {
      const Eigen::Vector2d distorted = camera.from_pixel(Eigen::Vector2d(u, v));
      const Eigen::Vector2d normalised = camera.undistort(distorted);
      ASSERT_TRUE(normalised.allFinite()) << u << " " << v;
      worst_pixel_side = std::max(worst_pixel_side, (camera.distort(normalised) - distorted).norm());
      worst_normalised_side =
          std::max(worst_normalised_side, (camera.undistort(camera.distort(normalised)) - normalised).norm());
    }
  EXPECT_LT(worst_pixel_side, 1e-12);
  EXPECT_LT(worst_normalised_side, 1e-12);
  RecordProperty("round_trip", std::to_string(worst_normalised_side * 1e15) + "e-15");
}

TEST(Camera, UndistortOfABarrelFollowsTheLensUpToTheFoldAndIsNaNBehindIt) {
  Camera camera = table2_camera();
  camera.k1 = -0.4;
  camera.k2 = camera.k3 = camera.k4 = 0;
  const double fold = std::sqrt(1 / 1.2), highest = fold * (1 - 0.4 * fold * fold);
  for (double r = 0.01; r < 0.999 * fold; r += 0.01)
    EXPECT_NEAR(camera.undistort(camera.distort({r * 0.6, r * 0.8})).norm(), r, 1e-11);
  for (const double r : {highest * 1.001, 0.7, 1.0, 3.0, 100.0})
    EXPECT_TRUE(camera.undistort({r, 0}).array().isNaN().all()) << r;
  EXPECT_TRUE(camera.undistort({std::numeric_limits<double>::quiet_NaN(), 0}).array().isNaN().any());
}

TEST(Camera, UndistortDoesNotTakeTheBranchBehindTheFold) {
  Camera camera = table2_camera();  // grows, falls, and grows again: the same distorted radius three times
  camera.k1 = -0.8;
  camera.k2 = 0.25;
  camera.k3 = camera.k4 = 0;
  for (double r = 0.05; r < 0.7; r += 0.05) EXPECT_NEAR(camera.undistort(camera.distort({r, 0})).x(), r, 1e-11);
  EXPECT_TRUE(camera.undistort({1.0, 0}).array().isNaN().all());
}

TEST(Camera, ProjectsAsOpenCv) {
  const Camera camera = table2_camera();
  auto random = test::seeded();
  std::vector<cv::Point3d> points;
  for (int i = 0; i < 200; ++i)
    points.emplace_back(test::uniform(random, -0.015, 0.015), test::uniform(random, -0.015, 0.015),
                        test::uniform(random, 0.045, 0.065));
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Vec4d distortion(camera.k1, camera.k2, camera.k3, camera.k4);
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), K, distortion, pixels);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d ours = camera.project({points[i].x, points[i].y, points[i].z});
    EXPECT_NEAR(ours.x(), pixels[i].x, 1e-9);
    EXPECT_NEAR(ours.y(), pixels[i].y, 1e-9);
  }
}

TEST(Camera, ValidateAcceptsTheRealOnesAndNamesEveryProblemAtOnce) {
  EXPECT_TRUE(table2_camera().validate().empty());
  EXPECT_TRUE(Camera::pinhole(640, 480, 1).validate().empty());
  Camera broken = table2_camera();
  broken.width = 0;
  broken.fx = -1;
  broken.cy = std::numeric_limits<double>::quiet_NaN();
  broken.k2 = std::numeric_limits<double>::infinity();
  const auto problems = broken.validate();
  EXPECT_EQ(problems.size(), 4u);
  for (const char* word : {"width", "fx", "cy", "k2"}) EXPECT_TRUE(mentions(problems, word)) << word;

  Camera folded = table2_camera();
  folded.k1 = -2;
  EXPECT_TRUE(mentions(folded.validate(), "cannot be inverted"));
  Camera beside = table2_camera();
  beside.cx = 800;
  EXPECT_TRUE(mentions(beside.validate(), "cx"));
  EXPECT_FALSE(Camera{}.validate().empty());
}

TEST(Camera, PinholeHasItsFieldOfViewBetweenTheOuterPixelEdges) {
  const Camera camera = Camera::pinhole(640, 480, 1.2);
  EXPECT_NEAR(std::atan(camera.normalise({-0.5, 0}).x()), -0.6, 1e-12);
  EXPECT_NEAR(std::atan(camera.normalise({639.5, 0}).x()), 0.6, 1e-12);
  EXPECT_NEAR(camera.normalise({319.5, 239.5}).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace heartservo::tracking
