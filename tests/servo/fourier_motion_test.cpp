#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "servo/prediction/beat_clock.hpp"
#include "servo/prediction/breath_clock.hpp"
#include "servo/prediction/fourier_motion.hpp"
#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/random.hpp"

namespace heartservo::servo {
namespace {

using Axes = FourierMotion::Axes;

// A motion of 3 cardiac harmonics that breathing modulates, as a function of both phases.
Axes motion(double heart, double breath) {
  const double u = 2 * std::numbers::pi * heart, v = 2 * std::numbers::pi * breath;
  const double gain = 1 + 0.1 * std::cos(v + 0.3);
  return Axes(2e-3 * std::cos(u) + 1e-3 * std::sin(2 * u), 1e-3 * std::sin(3 * u), 1e-3 * std::cos(u + 1)) * gain +
         Axes(0.01 + 1e-3 * std::sin(v), 0.02, 0.05 + 3e-3 * std::cos(v) + 5e-4 * std::sin(2 * v));
}

FourierMotion taught(int samples) {
  FourierOptions options;
  options.cardiac_harmonics = options.sidebands = 4;
  FourierMotion fourier(options);
  fourier.start(motion(0, 0), 1e-5, 4);
  auto random = test::seeded();
  FourierMotion::Basis h = fourier.make_basis();
  for (int k = 0; k < samples; ++k) {
    const double heart = 0.0095 * k, breath = 0.0027 * k;
    fourier.basis(heart, breath, h);
    Axes measured = motion(heart, breath);
    for (int i = 0; i < 3; ++i) measured[i] += test::normal(random, 1e-5);
    fourier.update(h, measured - fourier.value(h), 1, 0.008);
  }
  return fourier;
}

TEST(FourierMotion, LearnsAModulatedMotion) {
  const FourierMotion fourier = taught(4000);
  FourierMotion::Basis h = fourier.make_basis();
  for (double heart = 0; heart < 1; heart += 0.07)
    for (double breath = 0; breath < 1; breath += 0.13) {
      fourier.basis(heart, breath, h);
      EXPECT_LT((fourier.value(h) - motion(heart, breath)).norm(), 1e-5) << heart << " " << breath;
    }
}

TEST(FourierMotion, SlopesAreTheDerivatives) {
  const FourierMotion fourier = taught(1000);
  const auto value = [&](const Eigen::VectorXd& phases) -> Eigen::VectorXd {
    FourierMotion::Basis h = fourier.make_basis();
    fourier.basis(phases[0], phases[1], h);
    return fourier.value(h).transpose();
  };
  const Eigen::Vector2d at(0.37, 0.81);
  const Eigen::MatrixXd J = test::numeric_jacobian(value, at);
  FourierMotion::Basis h = fourier.make_basis();
  fourier.basis(at[0], at[1], h);
  Axes by_heart, by_breath;
  fourier.slopes(h, by_heart, by_breath);
  EXPECT_LT((by_heart.transpose() - J.col(0)).norm(), 1e-7);
  EXPECT_LT((by_breath.transpose() - J.col(1)).norm(), 1e-7);
}

TEST(FourierMotion, VarianceFallsWithExperience) {
  FourierMotion little = taught(150), much = taught(3000);
  FourierMotion::Basis h = little.make_basis();
  little.basis(0.2, 0.6, h);
  EXPECT_LT(much.variance(h), 0.2);
  EXPECT_GT(little.variance(h), 2 * much.variance(h));
}

TEST(BeatClock, OnlyDiastoleStretches) {
  BeatClock clock;
  clock.start({0, 0.35, 0}, 0, 1.2, 0.01, 0.001);
  double variance = 0, rate = 0;
  EXPECT_NEAR(clock.foresee(0.3, variance, rate), 0.36, 1e-9);
  EXPECT_NEAR(rate, 1.2, 1e-9);
  // the phase of a beat whose diastole runs a tenth faster, measured without noise to speak of
  const auto truth = [](double t) { return t < 0.35 ? 1.2 * t : 1.2 * 0.35 + 1.32 * (t - 0.35); };
  for (double t = 0.008; t < 0.55; t += 0.008) {
    clock.advance(0.008);
    clock.update(truth(t) - clock.phase(), 1, 1e-8);
  }
  EXPECT_NEAR(clock.stretch(), 0.1, 0.01);
  const double now = clock.phase(), left = (1 - now) / 1.32;
  EXPECT_NEAR(clock.foresee(left + 0.1, variance, rate), 1 + 0.12, 2e-3) << "systole runs at its own rate again";
}

TEST(BeatClock, UncertaintyOfTheNextDiastoleIsThatOfBeats) {
  BeatClock clock;
  clock.start({0, 0.35, 0}, 0.1, 1.2, 1e-4, 1e-4);
  double systole = 0, diastole = 0, rate = 0;
  clock.foresee(0.2, systole, rate);
  clock.foresee(0.6, diastole, rate);
  EXPECT_GT(diastole, 10 * systole);
  EXPECT_NEAR(std::sqrt(diastole), 1.2 * (0.6 - (0.35 - 0.1 / 1.2)) * clock.stretch_sigma(), 0.003);
}

TEST(BreathClock, FollowsARateThatIsNotItsOwn) {
  BreathClock clock;
  clock.start(0, 0.3, 0.02, 0.01);
  for (int k = 1; k < 3000; ++k) {
    clock.advance(0.008);
    clock.update(0.33 * 0.008 * k - clock.phase(), 1, 1e-5);
  }
  EXPECT_NEAR(clock.rate_hz(), 0.33, 0.003);
}

}  // namespace
}  // namespace heartservo::servo
