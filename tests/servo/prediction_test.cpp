#include <gtest/gtest.h>

#include <cmath>

#include "servo/prediction/registry.hpp"
#include "tests/support/random.hpp"

namespace heartservo::servo {
namespace {

Eigen::Vector3d breathing(double t) { return {2e-3 * std::sin(2 * t), 1e-3 * std::cos(3 * t), 5e-3 * std::sin(7 * t)}; }

double rms_at(const std::string& name, double horizon_s, double noise) {
  auto random = test::seeded();
  const auto predictor = predictors().make(name, PredictorOptions{});
  double sum = 0;
  int n = 0;
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.008 * k;
    MotionSample sample{t, breathing(t), Eigen::Matrix3d::Identity() * noise * noise};
    for (int i = 0; i < 3; ++i) sample.position[i] += test::normal(random, noise);
    predictor->observe(sample);
    if (k < 250) continue;
    sum += (predictor->predict(t + horizon_s).position - breathing(t + horizon_s)).squaredNorm();
    ++n;
  }
  return std::sqrt(sum / n);
}

TEST(Predictors, ConstantVelocityBeatsHoldOnSmoothMotion) {
  const double hold = rms_at("hold", 0.032, 1e-5), velocity = rms_at("constant_velocity", 0.032, 1e-5);
  EXPECT_NEAR(hold, 0.032 * 0.0249, 2e-4);  // horizon times the RMS speed
  EXPECT_LT(velocity, 0.25 * hold);
}

TEST(Predictors, ConstantVelocityIsExactOnAStraightLine) {
  const auto predictor = predictors().make("constant_velocity", PredictorOptions{});
  const Eigen::Vector3d start(0.01, -0.02, 0.05), velocity(0.1, -0.05, 0.02);
  for (int k = 0; k < 400; ++k) predictor->observe({0.008 * k, start + velocity * 0.008 * k, Eigen::Matrix3d::Zero()});
  const Prediction p = predictor->predict(0.008 * 399 + 0.05);
  ASSERT_TRUE(p.valid);
  EXPECT_LT((p.position - start - velocity * (0.008 * 399 + 0.05)).norm(), 1e-7);
  EXPECT_LT((p.velocity - velocity).norm(), 1e-6);
}

TEST(Predictors, GapsBadSamplesAndTimeGoingBackDoNoHarm) {
  for (const auto& name : predictors().names()) {
    const auto predictor = predictors().make(name, PredictorOptions{});
    EXPECT_FALSE(predictor->predict(1).valid) << name;
    predictor->observe({0, {0.001, 0, 0}, Eigen::Matrix3d::Zero()});
    predictor->observe({0.008, {0.002, 0, 0}, Eigen::Matrix3d::Zero()});
    predictor->observe({0.016, {NAN, 0, 0}, Eigen::Matrix3d::Zero()});
    predictor->observe({0.004, {9, 9, 9}, Eigen::Matrix3d::Zero()});
    predictor->observe({0.5, {0.002, 0, 0}, Eigen::Matrix3d::Constant(NAN)});
    const Prediction p = predictor->predict(0.55);
    EXPECT_TRUE(p.valid) << name;
    EXPECT_TRUE(p.position.allFinite() && p.velocity.allFinite() && p.covariance.allFinite()) << name;
    EXPECT_LT(p.position.norm(), 0.2) << name;
  }
}

TEST(Predictors, CovarianceGrowsWithTheHorizonAndMatchesTheErrors) {
  auto random = test::seeded();
  PredictorOptions options;
  const auto predictor = predictors().make("constant_velocity", options);
  // A target that moves as the filter believes: velocity is a random walk.
  const double dt = 0.008, noise = 5e-5, horizon = 0.032;
  double x = 0, v = 0, normalised = 0;
  std::vector<Prediction> due;
  int n = 0;
  for (int k = 0; k < 20000; ++k) {
    predictor->observe({dt * k, {x + test::normal(random, noise), 0, 0}, Eigen::Matrix3d::Identity() * noise * noise});
    due.push_back(predictor->predict(dt * k + horizon));
    if (k > 200) {
      const Prediction& p = due[due.size() - 5];
      normalised += std::pow(p.position.x() - x, 2) / p.covariance(0, 0);
      ++n;
    }
    const double a = test::normal(random, std::sqrt(options.acceleration_density * dt));
    x += dt * v + 0.5 * dt * a;
    v += a;
  }
  EXPECT_NEAR(normalised / n, 1, 0.15);
  EXPECT_GT(predictor->predict(20000 * dt + 0.1).covariance(0, 0), due.back().covariance(0, 0));
}

}  // namespace
}  // namespace heartservo::servo
