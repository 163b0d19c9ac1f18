// Motions made of known lines, with gaps and noise.
#include "servo/motion/motion_analysis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/message.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::servo {
namespace {

using Family = MotionLine::Family;
using test::message_of;
constexpr double kTau = 2 * std::numbers::pi;

struct Sine {
  double hz;
  Eigen::Vector3d mm;
};

MotionRecord record_of(const std::vector<Sine>& sines, double duration_s, double noise_mm, double rate_hz = 125) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  MotionRecord record;
  record.file = "made.csv";
  record.group = "measured";
  for (int i = 0; i < static_cast<int>(duration_s * rate_hz); ++i) {
    Eigen::Vector3d p(10, -20, 50);
    for (std::size_t k = 0; k < sines.size(); ++k)
      p += sines[k].mm * std::sin(kTau * sines[k].hz * i / rate_hz + 0.7 * static_cast<double>(k));
    record.truth.push_back(1e-3 * p);
    record.measured.push_back(1e-3 * (p + noise_mm * Eigen::Vector3d(normal(random), normal(random), normal(random))));
    record.time_s.push_back(i / rate_hz);
    record.line.push_back(i + 2);
  }
  return record;
}

const std::vector<Sine> kHeart{{0.25, {1, 0.3, 3}}, {0.5, {0.2, 0.1, 0.8}}, {1.3, {2, 1, 0.9}}, {2.6, {1, 0.5, 0.6}}};

const MotionLine* find(const MotionAnalysis& m, Family family, int harmonic) {
  for (const auto& line : m.lines)
    if (line.family == family && line.harmonic == harmonic) return &line;
  return nullptr;
}

TEST(MotionAnalysis, NamesMeasuresAndWeighsTheLines) {
  const auto record = record_of(kHeart, 20, 0.02);
  const auto m = analyse(record, record.measured, {});
  EXPECT_NEAR(m.rhythm.heart_hz, 1.3, 0.002);
  EXPECT_NEAR(m.rhythm.respiration_hz, 0.25, 0.002);
  ASSERT_EQ(m.lines.size(), 4U);
  const std::pair<Family, int> order[] = {
      {Family::RESPIRATION, 1}, {Family::RESPIRATION, 2}, {Family::HEART, 1}, {Family::HEART, 2}};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(std::pair(m.lines[k].family, m.lines[k].harmonic), order[k]);
    double power = 0;
    for (int a = 0; a < 3; ++a) {
      power = 0;
      for (const auto& s : kHeart) power += s.mm[a] * s.mm[a];
      EXPECT_NEAR(m.lines[k].amplitude_m[a], 1e-3 * kHeart[k].mm[a], 3e-5) << name_of(m.lines[k]);
      EXPECT_NEAR(m.lines[k].density_percent[a], 100 * kHeart[k].mm[a] * kHeart[k].mm[a] / power, 0.5);
    }
  }
  EXPECT_EQ(name_of(m.lines[3]), "heart 2");
}

TEST(MotionAnalysis, SplitsRespirationAndMeasuresBothParts) {
  const auto record = record_of(kHeart, 20, 0.02);
  const auto m = analyse(record, record.measured, {});
  EXPECT_EQ(m.split_hz, 1);
  for (std::size_t i = 500; i < 2000; ++i) {
    const double t = record.time_s[i];
    double slow = 50, fast = 0;
    for (std::size_t k = 0; k < 4; ++k)
      (k < 2 ? slow : fast) += kHeart[k].mm.z() * std::sin(kTau * kHeart[k].hz * t + 0.7 * static_cast<double>(k));
    EXPECT_NEAR(1e3 * m.respiration[2][i], slow, 0.03);
    EXPECT_NEAR(1e3 * m.beat[2][i], fast, 0.05);
  }
}

// The stated standard deviation of the acceleration is the one that the noise makes.
TEST(MotionAnalysis, AccelerationAndItsUncertainty) {
  const auto record = record_of(kHeart, 60, 0.05);
  AnalysisOptions options;
  options.cutoff_hz = 8;
  const auto noisy = analyse(record, record.measured, options), clean = analyse(record, record.truth, options);
  for (std::size_t a = 0; a < 3; ++a) {
    double velocity = 0, acceleration = 0;
    const std::size_t from = 100, to = noisy.motion.size() - 100;
    for (std::size_t i = from; i < to; ++i) {
      velocity += std::pow(noisy.velocity[a][i] - clean.velocity[a][i], 2) / static_cast<double>(to - from);
      acceleration += std::pow(noisy.acceleration[a][i] - clean.acceleration[a][i], 2) / static_cast<double>(to - from);
    }
    EXPECT_NEAR(noisy.axis[a].velocity_sigma, std::sqrt(velocity), 0.15 * std::sqrt(velocity));
    EXPECT_NEAR(noisy.axis[a].acceleration_sigma, std::sqrt(acceleration), 0.15 * std::sqrt(acceleration));
    EXPECT_NEAR(1e3 * noisy.axis[a].noise_m, 0.05, 0.005);
    EXPECT_EQ(noisy.axis[a].cutoff_hz, 8);
    double truth = 0;
    for (std::size_t i = 63; i + 63 < record.time_s.size(); ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < 4; ++k)
        sum -= 1e-3 * kHeart[k].mm[static_cast<Eigen::Index>(a)] * std::pow(kTau * kHeart[k].hz, 2) *
               std::sin(kTau * kHeart[k].hz * record.time_s[i] + 0.7 * static_cast<double>(k));
      truth = std::max(truth, std::abs(sum));
    }
    EXPECT_NEAR(clean.axis[a].max_acceleration, truth, 0.01 * truth);
    EXPECT_NEAR(noisy.axis[a].max_acceleration, truth, 0.1 * truth + 3 * noisy.axis[a].acceleration_sigma);
  }
}

TEST(MotionAnalysis, ASlowHeartIsSplitBelowItsOwnLine) {
  const auto record = record_of({{0.2, {1, 1, 2}}, {0.8, {1, 1, 1}}, {1.6, {0.5, 0.6, 0.4}}}, 30, 0.02);
  const auto m = analyse(record, record.measured, {});
  EXPECT_NEAR(m.rhythm.heart_hz, 0.8, 0.003);
  EXPECT_NEAR(m.split_hz, 0.68, 0.01);
  ASSERT_FALSE(m.notes.empty());
  EXPECT_NE(m.notes[0].find("0.68 Hz instead of 1 Hz"), std::string::npos);
}

TEST(MotionAnalysis, LinesOutsideTheFamiliesAreListed) {
  auto sines = kHeart;
  sines.push_back({1.3 + 0.25, {0.8, 0.4, 0.4}});
  sines.push_back({3.3, {0.8, 0.4, 0.4}});
  const auto record = record_of(sines, 40, 0.02);
  const auto m = analyse(record, record.measured, {});
  const auto* sideband = find(m, Family::SIDEBAND, 1);
  ASSERT_NE(sideband, nullptr);
  EXPECT_EQ(name_of(*sideband), "heart 1 + respiration 1");
  EXPECT_NEAR(sideband->frequency_hz, 1.55, 0.01);
  const auto* other = find(m, Family::OTHER, 0);
  ASSERT_NE(other, nullptr);
  EXPECT_NEAR(other->frequency_hz, 3.3, 0.01);
}

TEST(MotionAnalysis, GapsAndUnevenRowsAreBridged) {
  auto record = record_of(kHeart, 20, 0);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> jitter(-0.001, 0.001);
  for (std::size_t i = 400; i < 430; ++i) record.measured[i].setConstant(NAN);  // 0.24 s
  auto whole = analyse(record, record.truth, {});
  const auto m = analyse(record, record.measured, {});
  EXPECT_EQ(m.motion.filled, 30U);
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(m.lines[2].density_percent[a], whole.lines[2].density_percent[a], 0.5);
}

TEST(MotionAnalysis, WhatCannotBeAnalysedIsRefusedByName) {
  const auto says = [](const MotionRecord& r, const AnalysisOptions& o = {}) {
    return message_of<InputError>([&] { analyse(r, r.measured, o); });
  };
  EXPECT_NE(says(record_of(kHeart, 5, 0.02)).find("made.csv: 4.99 s of motion"), std::string::npos);
  EXPECT_NE(says(record_of({}, 20, 0)).find("made.csv:2: the position is the same in every row"), std::string::npos);
  EXPECT_NE(says(record_of(kHeart, 20, 0.02, 5)).find("5 rows a second"), std::string::npos);
  auto gap = record_of(kHeart, 20, 0.02);
  for (std::size_t i = 400; i < 500; ++i) gap.measured[i].setConstant(NAN);
  EXPECT_NE(says(gap).find("made.csv:502: 0.808 s without a position before 4 s"), std::string::npos) << says(gap);
  for (auto& p : gap.measured) p.setConstant(NAN);
  EXPECT_NE(says(gap).find("only 0 rows"), std::string::npos);
  AnalysisOptions high;
  high.cutoff_hz = 60;
  const auto record = record_of(kHeart, 20, 0.02);
  EXPECT_NE(message_of<ConfigError>([&] { analyse(record, record.measured, high); }).find("60 Hz is too high"),
            std::string::npos);
  EXPECT_EQ((AnalysisOptions{.segment_s = 1, .split_hz = 5, .cutoff_hz = 2}).validate().size(), 2U);
}

// One axis that stands still is no reason to refuse; noise without rhythm has no family.
TEST(MotionAnalysis, OneStillAxisAndNoRhythm) {
  auto still = record_of(kHeart, 20, 0.02);
  for (auto& p : still.measured) p.y() = 1;
  const auto m = analyse(still, still.measured, {});
  EXPECT_NEAR(m.rhythm.heart_hz, 1.3, 0.003);
  EXPECT_EQ(m.axis[1].max_acceleration, 0);
  for (const auto& line : m.lines) EXPECT_EQ(line.density_percent.y(), 0);
  const auto noise = record_of({}, 60, 0.5);
  const auto n = analyse(noise, noise.measured, {});
  EXPECT_EQ(n.rhythm.respiration_hz, 0);
  EXPECT_TRUE(n.lines.empty());
  EXPECT_FALSE(n.notes.empty());
}

}  // namespace
}  // namespace heartservo::servo
