#include "servo/ecg/r_peak_detector.hpp"

#include <gtest/gtest.h>

#include "servo/ecg/beat_score.hpp"
#include "servo/ecg/ecg_record.hpp"
#include "tests/servo/ecg/made_ecg.hpp"
#include "tests/support/files.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::servo {
namespace {

using test::MadeEcg;

std::vector<RPeak> peaks_of(const std::vector<double>& samples, double rate_hz) {
  RPeakDetector detector(rate_hz);
  std::vector<RPeak> peaks;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (const auto peak = detector.next(static_cast<double>(i) / rate_hz, samples[i])) peaks.push_back(*peak);
  return peaks;
}

std::vector<double> times(const std::vector<RPeak>& peaks) {
  std::vector<double> result;
  for (const auto& p : peaks) result.push_back(p.time_s);
  return result;
}

// All but the last half second, whose beats may not be known yet.
BeatScore score(const std::vector<RPeak>& peaks, const MadeEcg& ecg, double duration_s) {
  std::vector<double> labels;
  for (const double b : ecg.beats)
    if (b < duration_s - 0.3) labels.push_back(b);
  return score_beats(times(peaks), labels, 0.05);
}

TEST(RPeakDetector, FindsEveryBeatAtAnyRateGainAndSamplingRate) {
  for (const double rate_hz : {125.0, 250.0, 360.0, 1000.0})
    for (const double period_s : {0.4, 0.8, 1.5})
      for (const double gain : {1.0, -1.0, 500.0}) {
        MadeEcg ecg = MadeEcg::even(60, period_s, 0.05, 11);
        ecg.rate_hz = rate_hz;
        ecg.gain = gain;
        const auto s = score(peaks_of(ecg.samples(60, 5), rate_hz), ecg, 60);
        EXPECT_EQ(s.matched, s.labels) << rate_hz << " " << period_s << " " << gain;
        EXPECT_LE(s.detected, s.labels + 1) << rate_hz << " " << period_s << " " << gain;
        EXPECT_LT(s.largest_error_s, 0.008);
        EXPECT_LT(s.sigma_error_s, 0.002);
      }
}

TEST(RPeakDetector, WideBeatsThatComeEarlyAreBeats) {
  MadeEcg ecg = MadeEcg::even(120, 0.8, 0.03, 3);
  for (std::size_t k = 6; k + 2 < ecg.beats.size(); k += 7) {
    ecg.beats[k] -= 0.3 * 0.8;
    ecg.wide.push_back(k);
  }
  const auto s = score(peaks_of(ecg.samples(120, 9), ecg.rate_hz), ecg, 120);
  EXPECT_EQ(s.matched, s.labels);
  EXPECT_LE(s.detected, s.labels + 1);
  EXPECT_LT(s.largest_error_s, 0.02);
}

// No sample after `known_s` has any influence, and peaks come in order, each with the stated delay.
TEST(RPeakDetector, IsCausalWithTheStatedDelay) {
  const MadeEcg ecg = MadeEcg::even(30, 0.8, 0.05, 4);
  auto samples = ecg.samples(30, 1);
  const auto whole = peaks_of(samples, ecg.rate_hz);
  const RPeakDetector detector(ecg.rate_hz);
  EXPECT_LT(detector.delay_s(), 0.13);
  std::size_t usual = 0;
  for (std::size_t k = 0; k < whole.size(); ++k) {
    if (k > 0) {
      EXPECT_GT(whole[k].time_s, whole[k - 1].time_s);
    }
    if (whole[k].looked_back) continue;
    ++usual;
    EXPECT_LE(whole[k].known_s - whole[k].time_s, detector.delay_s() + 1e-9);
  }
  EXPECT_GT(usual, whole.size() - 5);
  const auto cut = static_cast<std::size_t>(20 * ecg.rate_hz);
  for (std::size_t i = cut; i < samples.size(); ++i) samples[i] = 1000;
  const auto changed = peaks_of(samples, ecg.rate_hz);
  for (std::size_t k = 0; whole[k].known_s < 20 - 1 / ecg.rate_hz; ++k) EXPECT_EQ(whole[k].time_s, changed[k].time_s);
}

TEST(RPeakDetector, NoBeatsInSilenceNoiseOrALeadThatIsOff) {
  EXPECT_TRUE(peaks_of(std::vector<double>(10000, 0.3), 250).empty());
  EXPECT_TRUE(peaks_of(std::vector<double>(10000, NAN), 250).empty());
  const MadeEcg ecg = MadeEcg::even(60, 0.8, 0.03, 6);
  auto samples = ecg.samples(60, 2);
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (i > 20 * 360 && i < 35 * 360) samples[i] = NAN;
  const auto peaks = peaks_of(samples, 360);
  std::size_t inside = 0, after = 0, labels_after = 0;
  for (const auto& p : peaks) inside += p.time_s > 20.3 && p.time_s<34.9, after += p.time_s> 38;
  for (const double b : ecg.beats) labels_after += b > 38 && b < 59.7;
  EXPECT_EQ(inside, 0U);
  EXPECT_GE(after, labels_after) << "found again";
}

TEST(RPeakDetector, AnArtefactDoesNotDeafenIt) {
  const MadeEcg ecg = MadeEcg::even(60, 0.8, 0.03, 8);
  auto samples = ecg.samples(60, 3);
  for (std::size_t i = 0; i < 20; ++i) samples[static_cast<std::size_t>(25.0 * 360) + i] += 40;
  const auto s = score(peaks_of(samples, 360), ecg, 60);
  EXPECT_GE(s.matched + 2, s.labels);
  EXPECT_LE(s.detected, s.labels + 2);
}

TEST(RPeakDetector, RefusesTooFewSamples) { EXPECT_THROW(RPeakDetector(40), ConfigError); }

// The goal: 99.5 % of both against the experts' labels, within 50 ms.
TEST(RPeakDetector, OnARecordedEcg) {
  const auto record_file = test::data("ecg/100.hea");
  SKIP_WITHOUT_DATA(record_file);
  for (const std::string lead : {"MLII", "V5"}) {
    const EcgRecord record = read_ecg(record_file.string(), lead);
    const auto peaks = peaks_of(record.value, record.rate_hz);
    const auto labels = read_annotated_beats(annotations_of(record), record.rate_hz);
    ASSERT_EQ(labels.size(), 2273U);
    const auto s = score_beats(times(peaks), labels, 0.05);
    std::printf("100 %s: %zu labels, sensitivity %.3f %%, positive predictivity %.3f %%, error %.2f +- %.2f ms\n",
                lead.c_str(), s.labels, s.sensitivity_percent(), s.positive_predictivity_percent(),
                1e3 * s.mean_error_s, 1e3 * s.sigma_error_s);
    EXPECT_GE(s.sensitivity_percent(), 99.5);
    EXPECT_GE(s.positive_predictivity_percent(), 99.5);
  }
}

TEST(BeatScore, MatchesNearestOnceEach) {
  const auto s = score_beats({1.0, 2.04, 2.96, 3.02, 5}, {1.01, 2, 3, 4}, 0.05);
  EXPECT_EQ(s.labels, 4U);
  EXPECT_EQ(s.detected, 5U);
  EXPECT_EQ(s.matched, 3U);
  EXPECT_NEAR(s.sensitivity_percent(), 75, 1e-9);
  EXPECT_NEAR(s.positive_predictivity_percent(), 60, 1e-9);
  EXPECT_NEAR(s.mean_error_s, (-0.01 + 0.04 + 0.02) / 3, 1e-9);
  EXPECT_EQ(score_beats({}, {1}, 0.05).sensitivity_percent(), 0);
  EXPECT_EQ(score_beats({1}, {}, 0.05).positive_predictivity_percent(), 0);
  EXPECT_EQ(score_beats({1.03}, {1.0, 1.04}, 0.05).matched, 1U);
}

}  // namespace
}  // namespace heartservo::servo
