#include "servo/control/surgeon_path.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace heartservo::servo {
namespace {

PathOptions path_of(const std::string& type) {
  PathOptions options;
  options.type = type;
  options.start_s = 0.5;
  options.period_s = 2;
  return options;
}

TEST(SurgeonPath, HoldStaysAndEveryFigureBeginsAtRest) {
  EXPECT_TRUE(SurgeonPath().position(7).isZero());
  EXPECT_EQ(SurgeonPath().reach_m(), 0);
  for (const char* type : {"circle", "suture"}) {
    const SurgeonPath path(path_of(type));
    EXPECT_TRUE(path.position(0.3).isZero());
    EXPECT_LT(path.velocity(0.502).norm(), 1e-4) << type;
    EXPECT_GT(path.reach_m(), 0.0019) << type;
  }
}

TEST(SurgeonPath, TheCircleIsACircleAfterItsFirstTurn) {
  const SurgeonPath path(path_of("circle"));
  for (double t = 2.6; t < 8; t += 0.1) {
    EXPECT_NEAR(path.position(t).norm(), 0.002, 1e-12);
    EXPECT_NEAR(path.velocity(t).norm(), 0.002 * M_PI, 1e-7);
  }
}

TEST(SurgeonPath, StitchesAdvanceByThePitchAndEnd) {
  const SurgeonPath path(path_of("suture"));
  for (int n = 0; n <= 3; ++n) {
    const Eigen::Vector3d p = path.position(0.5 + 2 * n);
    EXPECT_LT((p - Eigen::Vector3d(0.0015 * n, 0, 0)).norm(), 1e-9);
  }
  EXPECT_NEAR(path.position(1.5).y(), 0.002, 1e-12);  // across the vessel
  EXPECT_NEAR(path.position(1.0).z(), 0.0005, 1e-12);  // and into the tissue on the way
  EXPECT_LT((path.position(60) - Eigen::Vector3d(0.0045, 0, 0)).norm(), 1e-9);
}

TEST(SurgeonPath, ARecordedHandIsMetAtItsPointsAndSmoothBetween) {
  std::vector<PathPoint> points{{10, {0.001, 0, 0}}, {10.5, {0.002, 0.001, 0}}, {11.5, {0.001, 0.003, -0.001}},
                                {12, {0, 0, 0}}};
  const SurgeonPath path(path_of("file"), points);
  for (const auto& p : points)
    EXPECT_LT((path.position(p.time_s - 10 + 0.5) - (p.position - points[0].position)).norm(), 1e-12);
  EXPECT_LT((path.position(30) - Eigen::Vector3d(-0.001, 0, 0)).norm(), 1e-12);
  for (double t = 0.4; t < 2.6; t += 0.01)
    EXPECT_LT((path.velocity(t + 0.01) - path.velocity(t)).norm(), 1.2e-3) << t;  // no kink: straight lines would turn by 4e-3
  EXPECT_NEAR(path.reach_m(), std::sqrt(9e-6 + 1e-6), 1e-9);
}

TEST(SurgeonPath, TypeAndFileMustAgree) {
  PathOptions options;
  options.type = "file";
  EXPECT_EQ(options.validate().size(), 1U);
  options.type = "hold";
  options.file = "a.csv";
  EXPECT_EQ(options.validate().size(), 1U);
}

}  // namespace
}  // namespace heartservo::servo
