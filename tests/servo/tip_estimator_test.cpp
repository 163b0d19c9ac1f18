#include "servo/robot/tip_estimator.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/random.hpp"

namespace heartservo::servo {
namespace {

struct Bench {
  Eigen::Matrix3d R_true = Eigen::AngleAxisd(0.0175, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  Eigen::Vector3d off{0.0006, -0.0006, 0.0005};
  Eigen::Vector3d to_tip{-0.0066, -0.0052, 0.0062};
  std::mt19937_64 random = test::seeded();

  // Error of the tip (RMS, m) in the second half of `seconds`, with a tool that swings by `swing` along each axis.
  double error(const TipOptions& options, double swing, double seconds = 8) {
    TipEstimator estimator(options, ToolRobotData{}, to_tip);
    double sum = 0;
    int n = 0;
    for (double t = 0; t < seconds; t += 0.008) {
      const Eigen::Vector3d way = swing * Eigen::Vector3d(std::sin(7 * t), std::sin(11 * t + 1), std::sin(2.2 * t));
      ToolState encoders;
      encoders.time_s = t;
      encoders.tip = Eigen::Vector3d(0, 0, 0.055) + way;
      const Eigen::Vector3d truth = Eigen::Vector3d(0, 0, 0.055) + off + R_true * way;
      tracking::TargetState marker;
      marker.time_s = t;
      marker.state = tracking::TrackState::OK;
      marker.T_camera_target.translation() =
          truth - to_tip + Eigen::Vector3d(test::normal(random, 1e-5), test::normal(random, 1e-5),
                                           test::normal(random, 4e-5));
      marker.position_covariance = Eigen::Vector3d(1e-10, 1e-10, 1.6e-9).asDiagonal();
      const Eigen::Vector3d tip = estimator.estimate(encoders, marker);
      if (t > seconds / 2) sum += (tip - truth).squaredNorm(), ++n;
    }
    R_learnt = estimator.R_camera_base();
    return std::sqrt(sum / n);
  }
  Eigen::Matrix3d R_learnt;
};

TEST(TipEstimator, LearnsOffsetAndRotationOfAWrongCalibration) {
  Bench bench;
  EXPECT_LT(bench.error(TipOptions{}, 0.004), 1e-5);
  EXPECT_LT(Eigen::AngleAxisd(bench.R_learnt.transpose() * bench.R_true).angle(), 0.002);
}

TEST(TipEstimator, WithoutTheRotationAMovingToolIsOffByIt) {
  Bench bench;
  TipOptions options;
  options.rotation_prior = 0;
  EXPECT_GT(bench.error(options, 0.004), 4e-5);
}

TEST(TipEstimator, AToolThatStandsLearnsItsOffsetAndInventsNoRotation) {
  Bench bench;
  EXPECT_LT(bench.error(TipOptions{}, 0), 2e-5);
  EXPECT_LT(Eigen::AngleAxisd(bench.R_learnt).angle(), 1e-9);
}

TEST(TipEstimator, PositionBasedItKeepsTheWholeError) {
  Bench bench;
  TipOptions options;
  options.use_marker = false;
  EXPECT_GT(bench.error(options, 0.004), 0.9e-3);
}

TEST(TipEstimator, TheMarkersArmTurnsWithTheTool) {
  TipEstimator estimator(TipOptions{}, ToolRobotData{}, {0.01, 0, 0});
  ToolState encoders;
  encoders.R_start_tool = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  tracking::TargetState marker;
  marker.state = tracking::TrackState::OK;
  marker.T_camera_target.translation() = Eigen::Vector3d(0, 0, 0.05);
  marker.position_covariance = 1e-12 * Eigen::Matrix3d::Identity();
  EXPECT_LT((estimator.estimate(encoders, marker) - Eigen::Vector3d(0, 0.01, 0.05)).norm(), 1e-5);
}

}  // namespace
}  // namespace heartservo::servo
