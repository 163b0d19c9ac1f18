// What the predictors must reach, on a few seeds; tests/bench/prediction_goals.cpp has many.
#include <gtest/gtest.h>

#include <cmath>

#include "servo/motion/prediction_score.hpp"
#include "servo/prediction/rate_search.hpp"
#include "servo/prediction/registry.hpp"
#include "tests/support/random.hpp"
#include "tests/support/reference_motion.hpp"

namespace heartservo::servo {
namespace {

using test::ReferenceMotion;

PredictionScore score_of(const std::string& name, ReferenceMotion motion, double duration_s, bool beats = false) {
  motion = test::drawn(motion, duration_s, test::seeded()());
  const MotionRecord record = test::recorded(motion, duration_s, test::seeded(1)());
  ScoreOptions options{{0.016, 0.064}, 25, {}};
  if (beats) options.r_peaks_s = motion.r_peaks_s;
  const auto predictor = predictors().make(name, PredictorOptions{});
  return score_predictor(record, options, *predictor);
}

void expect_z(const PredictionScore& score, double at_16_ms, double at_64_ms) {
  EXPECT_LT(1e3 * score.horizons[0].axis_rms_m.z(), at_16_ms);
  EXPECT_LT(1e3 * score.horizons[1].axis_rms_m.z(), at_64_ms);
  EXPECT_LT(1e3 * score.horizons[0].rms_m, 1.6 * at_16_ms);
  EXPECT_LT(1e3 * score.horizons[1].rms_m, 1.6 * at_64_ms);
  EXPECT_EQ(score.unlocks, 0);
}

TEST(PredictionGoals, SixLineTwoPercent) { expect_z(score_of("mixture", {}, 45), 0.035, 0.06); }

TEST(PredictionGoals, SixLineFivePercent) {
  ReferenceMotion motion;
  motion.beat_variability = 0.05;
  expect_z(score_of("mixture", motion, 45), 0.05, 0.11);
}

TEST(PredictionGoals, SharpTwoPercent) {
  ReferenceMotion motion;
  motion.sharp = true;
  expect_z(score_of("mixture", motion, 45), 0.05, 0.1);
}

TEST(PredictionGoals, BeatsHelpTheHarmonicModel) { expect_z(score_of("harmonic_ecg", {}, 45, true), 0.035, 0.06); }

TEST(PredictionGoals, AnOcclusionOfHalfASecondIsCoasted) {
  const ReferenceMotion motion = test::drawn({}, 40, test::seeded()());
  MotionRecord record = test::recorded(motion, 40, test::seeded(1)());
  double sum = 0, sum_back = 0;
  long n = 0, n_back = 0;
  const auto gone = [](double t) { return std::fmod(t, 3) > 1 && std::fmod(t, 3) < 1.5 && t > 20; };
  const auto back = [](double t) { return std::fmod(t, 3) >= 1.5 && std::fmod(t, 3) < 1.6 && t > 20; };
  for (std::size_t i = 0; i < record.time_s.size(); ++i)
    if (gone(record.time_s[i])) record.measured[i].setConstant(NAN);
  const auto predictor = predictors().make("mixture", PredictorOptions{});
  score_predictor(record, {{0.016}, 20, {}}, *predictor,
                  [&](std::size_t row, std::size_t, const Prediction& p, const Eigen::Vector3d& there) {
                    if (!there.allFinite()) return;
                    const double square = (p.position - there).squaredNorm();
                    if (gone(record.time_s[row])) sum += square, ++n;
                    if (back(record.time_s[row])) sum_back += square, ++n_back;
                  });
  EXPECT_LT(1e3 * std::sqrt(sum / static_cast<double>(n)), 0.5);
  // no predictor that goes by the last few samples has a say over the gap's edge
  EXPECT_LT(1e3 * std::sqrt(sum_back / static_cast<double>(n_back)), 0.3);
}

TEST(PredictionGoals, AnEarlyBeatIsFollowed) {
  ReferenceMotion motion = test::drawn({}, 60, test::seeded()());
  auto& r = motion.r_peaks_s;
  const auto early = static_cast<std::size_t>(std::upper_bound(r.begin(), r.end(), 30.0) - r.begin());
  const double shift = 0.3 * (r[early] - r[early - 1]);
  for (std::size_t i = early; i < r.size(); ++i) r[i] -= shift;
  const MotionRecord record = test::recorded(motion, 36, test::seeded(1)());
  double peak = 0, sum = 0;
  long n = 0;
  const auto predictor = predictors().make("mixture", PredictorOptions{});
  score_predictor(record, {{0.016}, 20, {}}, *predictor,
                  [&](std::size_t row, std::size_t, const Prediction& p, const Eigen::Vector3d& there) {
                    const double t = record.time_s[row];
                    if (!there.allFinite() || t < r[early - 1]) return;
                    peak = std::max(peak, (p.position - there).norm());
                    if (t < r[early + 2] || t > r[early + 4]) return;
                    sum += (p.position - there).squaredNorm();
                    ++n;
                  });
  EXPECT_LT(1e3 * peak, 2);
  EXPECT_LT(1e3 * std::sqrt(sum / static_cast<double>(n)), 0.3);
}

TEST(PredictionGoals, TheMixtureIsHardlyWorseThanTheBestSimpleOne) {
  for (const double variability : {0.02, 0.05}) {
    ReferenceMotion motion;
    motion.beat_variability = variability;
    const PredictionScore mixed = score_of("mixture", motion, 35);
    for (const char* name : {"hold", "constant_velocity", "constant_acceleration", "autoregressive"}) {
      const PredictionScore simple = score_of(name, motion, 35);
      for (std::size_t h = 0; h < 2; ++h)
        EXPECT_LT(mixed.horizons[h].rms_m, 1.1 * simple.horizons[h].rms_m) << name << " " << h;
    }
    const PredictionScore harmonic = score_of("harmonic", motion, 35);
    for (std::size_t h = 0; h < 2; ++h)
      EXPECT_LT(mixed.horizons[h].rms_m, harmonic.horizons[h].rms_m + 5e-6) << "it weighs with the others";
  }
}

TEST(RateSearch, FindsTheRatesOfAllHearts) {
  for (const double beats : {40.0, 75.0, 110.0, 150.0})
    for (const double breaths : {8.0, 16.0, 30.0}) {
      ReferenceMotion motion;
      motion.heart_rate_hz = beats / 60;
      motion.respiration_hz = breaths / 60;
      motion = test::drawn(motion, 10, test::seeded()());
      const MotionRecord record = test::recorded(motion, 5, test::seeded(1)());
      UniformTrack track(768);
      track.restart(0.016);
      for (std::size_t i = 0; i < record.time_s.size(); ++i)
        track.add(record.time_s[i], record.measured[i].transpose());
      RateSearch search;
      search.begin(track);
      int slices = 0;
      while (!search.step() && ++slices < 1000) {
      }
      EXPECT_LT(slices, 200);
      ASSERT_TRUE(search.found()) << beats << " " << breaths;
      EXPECT_NEAR(60 * search.beat_hz(), beats, 0.04 * beats) << breaths;
      EXPECT_NEAR(60 * search.breath_hz(), breaths, 0.25 * breaths) << beats;
    }
}

}  // namespace
}  // namespace heartservo::servo
