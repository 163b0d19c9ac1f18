// The simulated heart against the paper's Tables 3 and 4.
#include "sim/heart/heart_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <complex>

#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

constexpr double kStep_s = 0.008;

HeartMotionOptions regular(const char* profile) {
  HeartMotionOptions options;
  options.profile = profile;
  options.beat_variability = options.respiration_variability = 0;
  return options;
}

Eigen::MatrixX3d record(const HeartMotion& motion, double duration_s) {
  Eigen::MatrixX3d samples(static_cast<int>(duration_s / kStep_s), 3);
  for (int i = 0; i < samples.rows(); ++i) samples.row(i) = motion.displacement(i * kStep_s);
  return samples;
}

Eigen::RowVector3d peak_to_peak(const Eigen::MatrixX3d& x) { return x.colwise().maxCoeff() - x.colwise().minCoeff(); }

Eigen::RowVector3d rms(const Eigen::MatrixX3d& x) {
  return ((x.rowwise() - x.colwise().mean()).colwise().squaredNorm() / x.rows()).cwiseSqrt();
}

Eigen::RowVector3d peak_acceleration(const Eigen::MatrixX3d& x) {
  const auto n = x.rows() - 2;
  return ((x.topRows(n) - 2 * x.middleRows(1, n) + x.bottomRows(n)) / (kStep_s * kStep_s))
      .cwiseAbs()
      .colwise()
      .maxCoeff();
}

/// Power of the line at f, from a Hann window's coefficient.
double line_power(const Eigen::VectorXd& x, double f) {
  std::complex<double> sum = 0;
  double weights = 0;
  for (int i = 0; i < x.size(); ++i) {
    const double w = 1 - std::cos(2 * M_PI * (i + 0.5) / x.size());
    sum += w * x(i) * std::polar(1.0, -2 * M_PI * f * i * kStep_s), weights += w;
  }
  return 2 * std::norm(sum / weights);
}

TEST(HeartMotion, HasTheDensitiesOfTable3) {
  const Eigen::MatrixX3d x = record(HeartMotion(regular("six_line"), 1, 60), 60);
  const double lines[6] = {1 / 3., 2 / 3., 1.19, 2.38, 3.57, 4.76};
  const double printed[3][6] = {
      {8.7, 0, 21.8, 60, 2.8, 6.7}, {3.9, 1.9, 45.6, 33, 3.9, 11.7}, {70.9, 11.5, 5.9, 8.7, 1.2, 1.8}};
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 6; ++i)
      EXPECT_NEAR(100 * line_power(x.col(axis), lines[i]) / std::pow(rms(x)(axis), 2), printed[axis][i], 1)
          << "axis " << axis << ", " << lines[i] << " Hz";
}

TEST(HeartMotion, SharpHarmonicsAreEachBelowOnePercent) {
  const Eigen::MatrixX3d x = record(HeartMotion(regular("sharp"), 1, 60), 60);
  for (int n = 5; n <= 12; ++n) {
    const double share = 100 * line_power(x.col(2), 1.19 * n) / std::pow(rms(x)(2), 2);
    EXPECT_LT(share, 1) << n;
    EXPECT_GT(share, 0.005) << n;
  }
}

TEST(HeartMotion, HasTheSizeOfSection43AndOfTheReferenceRecords) {
  for (const char* profile : {"six_line", "sharp"}) {
    const Eigen::MatrixX3d x = record(HeartMotion(regular(profile), 1, 60), 60);
    EXPECT_NEAR(peak_to_peak(x).z() * 1e3, 11, 0.4) << profile;
    EXPECT_NEAR(rms(x).x() * 1e3, 2.65, 0.15) << profile;
    EXPECT_NEAR(rms(x).y() * 1e3, 1.6, 0.15) << profile;
    EXPECT_NEAR(rms(x).z() * 1e3, 2.7, 0.15) << profile;
  }
}

TEST(HeartMotion, SharpProfileHasTheAccelerationsOfTable4) {
  const Eigen::RowVector3d a = peak_acceleration(record(HeartMotion(regular("sharp"), 1, 60), 60));
  EXPECT_NEAR(a.x(), 1.73, 0.05);
  EXPECT_NEAR(a.y(), 1.09, 0.05);
  EXPECT_NEAR(a.z(), 3.67, 0.05);
}

TEST(HeartMotion, VariabilityAddsNoSpikesOfAcceleration) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    HeartMotionOptions options;
    const Eigen::RowVector3d a = peak_acceleration(record(HeartMotion(options, seed, 60), 60));
    EXPECT_NEAR(a.x(), 1.73, 0.1);
    EXPECT_NEAR(a.y(), 1.09, 0.1);
    EXPECT_NEAR(a.z(), 3.67, 0.15);
  }
}

TEST(HeartMotion, VelocityAndAccelerationAreContinuousAcrossBeatBorders) {
  HeartMotionOptions options;
  options.beat_variability = 0.1;
  const HeartMotion motion(options, 4, 30);
  const double h = 1e-5;
  for (const double beat : motion.beats())
    for (const double border : {beat, beat + kSystole_s}) {
      auto at = [&](int i) { return motion.displacement(border + i * h); };
      const Eigen::Vector3d before = (at(0) - at(-1)) / h, after = (at(1) - at(0)) / h;
      EXPECT_LT((after - before).norm(), 10 * h);  // no more than an acceleration of 10 m/s^2 would do
      const Eigen::Vector3d left = (at(-2) - 2 * at(-11) + at(-20)) / (81 * h * h);
      const Eigen::Vector3d right = (at(20) - 2 * at(11) + at(2)) / (81 * h * h);
      EXPECT_LT((right - left).norm(), 0.2);
    }
}

TEST(HeartMotion, IsDeterministicInTheSeed) {
  const HeartMotion a({}, 8, 20), b({}, 8, 20), c({}, 9, 20);
  EXPECT_EQ(a.displacement(7.3), b.displacement(7.3));
  EXPECT_NE(a.displacement(7.3), c.displacement(7.3));
}

TEST(HeartMotion, FollowsGivenBeats) {
  const HeartMotion motion({}, 1, 4, {0.1, 1.0, 2.2, 3.0, 4.1});
  for (const double beat : motion.beats()) EXPECT_NEAR(motion.cardiac_phase(beat), 0, 1e-12);
}

TEST(HeartMotion, TiltsByAFewDegrees) {
  const HeartMotion motion({}, 2, 20);
  double largest = 0;
  for (double t = 0; t < 20; t += 0.05) {
    const Eigen::Matrix3d R = motion.rotation(t);
    EXPECT_NEAR((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
    largest = std::max(largest, std::acos(std::min(1.0, (R.trace() - 1) / 2)));
  }
  EXPECT_GT(largest, 0.02);
  EXPECT_LT(largest, 0.07);
}

TEST(HeartMotion, StillHeartStandsStill) {
  HeartMotionOptions options;
  options.profile = "still";
  const HeartMotion motion(options, 2, 20);
  EXPECT_EQ(motion.displacement(3.3), Eigen::Vector3d::Zero());
  EXPECT_EQ(motion.rotation(3.3), Eigen::Matrix3d::Identity());
  EXPECT_EQ(motion.beat_strength(3.3), 0);
}

TEST(HeartMotion, RefusesARateWithoutDiastole) {
  HeartMotionOptions options;
  options.heart_rate_hz = 2.5;
  EXPECT_THROW(HeartMotion(options, 1, 10), ConfigError);
}

TEST(HeartMotion, TheRailRunsToAndFroAtConstantSpeedAndTurnsNothing) {
  HeartMotionOptions options;
  options.profile = "rail";
  options.rail = {0.02, 4, {0.1, -0.3, 0.05}};
  const HeartMotion motion(options, 1, 10);
  for (const auto& [t, z] : {std::pair{0.0, -0.01}, {1.0, 0.0}, {2.0, 0.01}, {2.5, 0.005}, {4.0, -0.01}, {5.0, 0.0}}) {
    EXPECT_LT((motion.displacement(t) - Eigen::Vector3d(0, 0, z)).norm(), 1e-12) << t;
    const Eigen::AngleAxisd turn(motion.rotation(t));
    EXPECT_LT((turn.angle() * turn.axis() - options.rail.turn_rad).norm(), 1e-9) << t;
    EXPECT_EQ(motion.beat_strength(t), 0) << t;
  }
  options.rail.period_s = 0;
  EXPECT_THROW(HeartMotion(options, 1, 10), ConfigError);
}

}  // namespace
}  // namespace heartservo::sim
