#include "tracking/landmark/dense_pose.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/table2_camera.hpp"
#include "tests/tracking/landmark/plate_scene.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

using test::SIDE;
using test::table2_camera;
using test::tilted_pose;

constexpr double DEGREE = M_PI / 180;

using Twist = Eigen::Matrix<double, 6, 1>;

const LandmarkTemplate& plate() {
  static const LandmarkTemplate made(test::wavy_plate(), test::kPlateBlur);
  return made;
}

Twist error_twist(const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(estimate.linear() * truth.linear().transpose()));
  Twist e;
  e << estimate.translation() - truth.translation(), turn.angle() * turn.axis();
  return e;
}

Eigen::Isometry3d shaken(std::mt19937_64& random, const Eigen::Isometry3d& T) {
  Twist twist;
  twist << test::normal(random, 3e-5), test::normal(random, 3e-5), test::normal(random, 3e-4),
      test::normal(random, 0.03), test::normal(random, 0.03), test::normal(random, 0.005);
  return moved(T, twist);
}

TEST(LandmarkTemplate, SamplesTheBlurredPlateAndItsSlopes) {
  auto random = test::seeded();
  cv::Mat sharp, soft;
  test::wavy_plate(1024).convertTo(sharp, CV_32F);
  cv::GaussianBlur(sharp, soft, {}, test::kPlateBlur * 512, test::kPlateBlur * 512, cv::BORDER_REPLICATE);
  const LandmarkTemplate made(test::wavy_plate(1024), test::kPlateBlur);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector2d at(test::uniform(random, -0.88, 0.88), test::uniform(random, -0.88, 0.88));
    ASSERT_TRUE(made.covers(at.x(), at.y()));
    PlateGrey grey, softening;
    made.sample(at.x(), at.y(), grey, softening);
    const int i = static_cast<int>((at.x() + 1) * 512), j = static_cast<int>((at.y() + 1) * 512);
    EXPECT_NEAR(grey.value, soft.at<float>(j, i), 3) << at.transpose();  // the nearest pixel, at up to 1500 grey per half side
    const auto both = [&](const Eigen::VectorXd& p) {
      PlateGrey T, D;
      made.sample(p(0), p(1), T, D);
      return Eigen::VectorXd(Eigen::Vector2d(T.value, D.value));
    };
    Eigen::Matrix2d J;
    J << grey.dx, grey.dy, softening.dx, softening.dy;
    EXPECT_LT((J - test::numeric_jacobian(both, at)).norm(), 1e-3 * (1 + J.norm()));
  }
  EXPECT_FALSE(made.covers(0.97, 0));
  EXPECT_FALSE(made.covers(0, NAN));
}

TEST(DensePose, JacobianIsTheDerivative) {
  auto random = test::seeded();
  for (int k = 0; k < 100; ++k) {
    const auto T = tilted_pose(random, test::uniform(random, 0, 45) * DEGREE, test::uniform(random, 0.045, 0.065));
    DenseLight light = test::some_light();
    light(6) = 0.3;
    const Eigen::Vector3d on_plate(test::uniform(random, -0.4, 0.4) * SIDE, test::uniform(random, -0.4, 0.4) * SIDE, 0);
    const Eigen::Vector3d ray = (T * on_plate).hnormalized().homogeneous();
    double grey;
    DenseRow row;
    ASSERT_TRUE(predict_grey(plate(), PlateView(T, SIDE), light, ray, grey, row));
    const auto predicted = [&](const Eigen::VectorXd& p) {
      double g = 0;
      DenseRow unused;
      predict_grey(plate(), PlateView(moved(T, p.head<6>()), SIDE), light + p.tail<kLightParameters>(), ray, g, unused);
      return Eigen::VectorXd(Eigen::VectorXd::Constant(1, g));
    };
    const Eigen::MatrixXd numeric =
        test::numeric_jacobian(predicted, Eigen::VectorXd::Zero(kDenseParameters), 1e-7);
    for (int i = 0; i < kDenseParameters; ++i)
      EXPECT_NEAR(row(i), numeric(0, i), 2e-4 * (1 + std::abs(row(i)) + row.head<6>().norm() * (i < 3 ? 1 : 0) +
                                                 row.segment<3>(3).norm() * (i >= 3 && i < 6 ? 1 : 0)))
          << i;
  }
}

TEST(DensePose, IsExactWithoutNoise) {
  const Camera camera = table2_camera();
  auto random = test::seeded();
  DenseRefiner refiner(camera);
  for (const double tilt : {0.0, 10.0, 30.0, 45.0}) {
    const auto truth = tilted_pose(random, tilt * DEGREE, test::uniform(random, 0.045, 0.065));
    const auto picture = test::plate_picture(random, camera, plate(), truth, test::some_light(), 0);
    const auto pose = refiner.refine(picture, plate(), SIDE, shaken(random, truth));
    ASSERT_TRUE(pose.valid) << tilt;
    const Twist e = error_twist(pose.T_camera_target, truth);
    EXPECT_LT(e.head<2>().norm(), 1e-6) << tilt;  // rounding to whole grey levels is all that is left
    EXPECT_LT(std::abs(e(2)), 1e-5) << tilt;
    EXPECT_NEAR(pose.rms_grey, std::sqrt(1 / 12.0), 0.03);
    EXPECT_GT(pose.share, 0.97);
  }
}

// Normalised error squared over POSES poses: chi2 with 6 POSES (whole twist) and 3 POSES (position) degrees of freedom
// if the covariance describes the errors.
TEST(DensePose, CovarianceDescribesTheErrors) {
  constexpr int POSES = 60;
  const Camera camera = table2_camera();
  auto random = test::seeded();
  DenseRefiner refiner(camera);
  double whole = 0, position = 0;
  for (int k = 0; k < POSES; ++k) {
    const auto truth = tilted_pose(random, test::uniform(random, 5, 45) * DEGREE, test::uniform(random, 0.045, 0.065));
    const auto picture = test::plate_picture(random, camera, plate(), truth, test::some_light(), 3);
    const auto pose = refiner.refine(picture, plate(), SIDE, shaken(random, truth));
    ASSERT_TRUE(pose.valid);
    const Twist e = error_twist(pose.T_camera_target, truth);
    whole += e.dot(pose.covariance.ldlt().solve(e));
    const Eigen::Matrix3d C = pose.covariance.topLeftCorner<3, 3>();
    position += e.head<3>().dot(C.ldlt().solve(e.head<3>()));
  }
  EXPECT_NEAR(whole, POSES * 6, 4 * std::sqrt(2.0 * POSES * 6));
  EXPECT_NEAR(position, POSES * 3, 4 * std::sqrt(2.0 * POSES * 3));
}

TEST(DensePose, WhatCoversThePlateOrSaturatesIsLeftOut) {
  const Camera camera = table2_camera();
  auto random = test::seeded();
  DenseRefiner refiner(camera);
  for (const int covering : {10, 255}) {
    const auto truth = tilted_pose(random, 20 * DEGREE, 0.055);
    cv::Mat picture = test::plate_picture(random, camera, plate(), truth, test::some_light(), 3);
    const Eigen::Vector2d corner = project_square(camera, truth, SIDE)[2];
    cv::circle(picture, {cvRound(corner.x()), cvRound(corner.y())}, 22, cv::Scalar(covering), cv::FILLED);
    const auto pose = refiner.refine(picture, plate(), SIDE, shaken(random, truth));
    ASSERT_TRUE(pose.valid);
    const Twist e = error_twist(pose.T_camera_target, truth);
    EXPECT_LT(e.dot(pose.covariance.ldlt().solve(e)), 25) << covering;  // chi2 of 6: beyond once in 3000
    EXPECT_LT(pose.share, 0.95);
    EXPECT_LT(pose.rms_grey, 4);  // covered pixels that happen to look alike still count
  }
}

TEST(DensePose, NothingToSeeIsNoPose) {
  const Camera camera = table2_camera();
  auto random = test::seeded();
  DenseRefiner refiner(camera);
  const auto truth = tilted_pose(random, 20 * DEGREE, 0.055);
  const cv::Mat picture = test::plate_picture(random, camera, plate(), truth, test::some_light(), 3);
  EXPECT_TRUE(refiner.refine(picture, plate(), SIDE, truth).valid);
  EXPECT_FALSE(refiner.refine(cv::Mat(512, 512, CV_8UC1, cv::Scalar(90)), plate(), SIDE, truth).valid) << "flat";
  EXPECT_FALSE(refiner.refine(cv::Mat(512, 512, CV_8UC1, cv::Scalar(255)), plate(), SIDE, truth).valid) << "glare";
  EXPECT_FALSE(refiner.refine(picture, LandmarkTemplate{}, SIDE, truth).valid);
  EXPECT_FALSE(refiner.refine(cv::Mat{}, plate(), SIDE, truth).valid);
  EXPECT_FALSE(refiner.refine(picture(cv::Rect(0, 0, 100, 100)), plate(), SIDE, truth).valid) << "another camera's";
  Eigen::Isometry3d elsewhere = truth;
  elsewhere.translation().x() += 0.5;
  EXPECT_FALSE(refiner.refine(picture, plate(), SIDE, elsewhere).valid) << "outside the picture";
  elsewhere.translation() = -truth.translation();
  EXPECT_FALSE(refiner.refine(picture, plate(), SIDE, elsewhere).valid) << "behind the camera";
  elsewhere = truth;
  elsewhere.translation().x() = NAN;
  EXPECT_FALSE(refiner.refine(picture, plate(), SIDE, elsewhere).valid);
  cv::Mat noise(512, 512, CV_8UC1);
  cv::theRNG().state = 7;
  cv::randu(noise, 0, 250);
  EXPECT_FALSE(refiner.refine(noise, plate(), SIDE, truth).valid) << "noise alone";
}

TEST(DensePose, WrongOptionsAreConfigurationErrors) {
  DenseOptions options;
  EXPECT_TRUE(options.validate().empty());
  options = {0, 0, 0, 2, 1, 1, 0};
  EXPECT_EQ(options.validate().size(), 7u);
  EXPECT_THROW(DenseRefiner(table2_camera(), options), ConfigError);
}

}  // namespace
}  // namespace heartservo::tracking
