#include "tracking/landmark/ippe_pose.hpp"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "tests/tracking/landmark/square_scene.hpp"
#include "tracking/landmark/square_pose.hpp"

namespace heartservo::tracking {
namespace {

std::array<Eigen::Vector2d, 4> seen(const Eigen::Isometry3d& T, double side_m) {
  std::array<Eigen::Vector2d, 4> corners;
  for (int i = 0; i < 4; ++i) corners[static_cast<std::size_t>(i)] = (T * square_corner(i, side_m)).hnormalized();
  return corners;
}

// OpenCV's, whose plane has y up and z towards the camera.
std::array<Eigen::Isometry3d, 2> by_opencv(const std::array<Eigen::Vector2d, 4>& corners, double side_m) {
  const std::vector<cv::Point3d> square{{-0.5, 0.5, 0}, {0.5, 0.5, 0}, {0.5, -0.5, 0}, {-0.5, -0.5, 0}};
  std::vector<cv::Point2d> points;
  for (const auto& corner : corners) points.emplace_back(corner.x(), corner.y());
  std::vector<cv::Vec3d> rotations, translations;
  cv::solvePnPGeneric(square, points, cv::Matx33d::eye(), cv::noArray(), rotations, translations, false,
                      cv::SOLVEPNP_IPPE_SQUARE);
  std::array<Eigen::Isometry3d, 2> poses;
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Vector3d w(rotations[i][0], rotations[i][1], rotations[i][2]);
    poses[i].setIdentity();
    poses[i].linear() = Eigen::AngleAxisd(w.norm(), w.normalized()) * Eigen::Vector3d(1, -1, -1).asDiagonal();
    poses[i].translation() = side_m * Eigen::Vector3d(translations[i][0], translations[i][1], translations[i][2]);
  }
  return poses;
}

TEST(IppePose, IsThatOfOpenCv) {
  auto random = test::seeded();
  for (int k = 0; k < 200; ++k) {
    const auto truth = test::tilted_pose(random, test::uniform(random, 0.05, 1), test::uniform(random, 0.04, 0.08));
    auto corners = seen(truth, 0.005);
    for (auto& corner : corners) corner += Eigen::Vector2d(test::normal(random, 2e-4), test::normal(random, 2e-4));
    std::array<Eigen::Isometry3d, 2> poses;
    ASSERT_TRUE(ippe_square_poses(corners, 0.005, poses));
    const auto wanted = by_opencv(corners, 0.005);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_LT((poses[i].matrix() - wanted[i].matrix()).norm(), 1e-6) << k;
  }
}

TEST(IppePose, FindsAPlateThatFacesTheCamera) {
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
  truth.translation().z() = 0.05;
  std::array<Eigen::Isometry3d, 2> poses;
  ASSERT_TRUE(ippe_square_poses(seen(truth, 0.005), 0.005, poses));
  for (const auto& pose : poses) EXPECT_LT((pose.matrix() - truth.matrix()).norm(), 1e-6);
}

TEST(IppePose, RefusesWhatIsNoSquare) {
  std::array<Eigen::Isometry3d, 2> poses;
  const Eigen::Vector2d nan = Eigen::Vector2d::Constant(NAN), zero = Eigen::Vector2d::Zero();
  EXPECT_FALSE(ippe_square_poses({nan, nan, nan, nan}, 0.005, poses));
  EXPECT_FALSE(ippe_square_poses({zero, zero, zero, zero}, 0.005, poses));
}

}  // namespace
}  // namespace heartservo::tracking
