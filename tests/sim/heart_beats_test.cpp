// The scene's beats and ECG: drawn, ectopic, from files; and what of them reaches a predictor in the loop.
#include "sim/table/heart_beats.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "servo/ecg/beat_score.hpp"
#include "servo/loop/loop.hpp"
#include "sim/heart/ecg_signal.hpp"
#include "sim/scene/scene.hpp"
#include "sim/table/stages.hpp"
#include "sim/table/table.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

using test::message_of;

Scene shipped(const std::string& name) { return load_scene(HEARTSERVO_SOURCE_DIR "/scenes/" + name + ".yaml"); }

std::vector<double> detected(servo::EcgSource& source, double until_s) {
  servo::RPeakDetector detector(source.rate_hz());
  std::vector<double> beats;
  for (servo::EcgSample sample; source.next(until_s, sample);)
    if (const auto peak = detector.next(sample.time_s, sample.value)) beats.push_back(peak->time_s);
  return beats;
}

std::vector<double> between(const std::vector<double>& beats, double from, double to) {
  std::vector<double> some;
  for (const double b : beats)
    if (b >= from && b <= to) some.push_back(b);
  return some;
}

TEST(EctopicBeats, ComeEarlyAreFollowedByAPauseAndLeaveTheOthersAlone) {
  const auto even = cycle_marks({1.19, 0, 0}, 2000, 5);
  const auto marks = with_ectopic_beats(even, 0.1, 0.3, 9);
  ASSERT_EQ(marks.size(), even.size());
  std::size_t early = 0;
  for (std::size_t i = 1; i < marks.size(); ++i) {
    if (marks[i] == even[i]) continue;
    ++early;
    EXPECT_NEAR(marks[i] - marks[i - 1], 0.7 / 1.19, 1e-9);
    EXPECT_NEAR(marks[i + 1] - marks[i], 1.3 / 1.19, 1e-9);
  }
  EXPECT_NEAR(static_cast<double>(early) / static_cast<double>(marks.size()), 0.1 / 1.1, 0.02);
  EXPECT_EQ(with_ectopic_beats(even, 0, 0.3, 9), even);
}

TEST(EcgSignal, HasItsRPeaksWhereTheHeartBeats) {
  const std::vector<double> beats{0.2, 1.0, 1.9, 2.4, 3.6};
  for (const double b : beats) {
    EXPECT_GT(ecg_mv(beats, b), 0.8);
    EXPECT_LT(std::abs(ecg_mv(beats, b - 0.1)), 0.3);
  }
  EXPECT_GT(ecg_mv(beats, 2.4 - 0.03), 0.4) << "an early beat is wide";
  EXPECT_LT(ecg_mv(beats, 1.9 - 0.03), 0.1);
  EXPECT_GT(ecg_mv(beats, 0.2 - 0.85), 0.8) << "it beat before, at its mean interval";
  EXPECT_GT(ecg_mv(beats, 3.6 + 5 * 0.85), 0.8);
  EXPECT_TRUE(std::isfinite(ecg_mv({}, 3)));
}

TEST(EcgSignal, ItsBeatsAreDetected) {
  for (const char* name : {"ecg_simulated", "arrhythmia"}) {
    Scene scene = shipped(name);
    scene.duration_s = 120;
    const HeartMotion motion = heart_motion(scene, 7);
    const auto ecg = heart_ecg(scene, motion.beats(), 8);
    const auto found = detected(*ecg, 120);
    const auto s = servo::score_beats(between(found, 0, 119.5), between(motion.beats(), 0, 119.5), 0.05);
    EXPECT_GE(s.sensitivity_percent(), 99) << name;
    EXPECT_GE(s.positive_predictivity_percent(), 99) << name;
    EXPECT_LT(s.sigma_error_s, 0.004) << name;
  }
}

TEST(HeartBeats, OfAFileDriveTheMotion) {
  const test::TemporaryFolder folder;
  folder.write("beats.csv", "time_s\n9.5\n10.4\n11.4\n12.2\n13.3\n14.1\n");
  Scene scene = shipped("pig_2007");
  scene.folder = folder.path();
  scene.duration_s = 3;
  scene.motion.beats = "beats.csv";
  const auto motion = heart_motion(scene, 1);
  ASSERT_EQ(motion.beats().size(), 6U);
  EXPECT_NEAR(motion.beats()[1], 0.4, 1e-9) << "the run begins at ecg.start_s";
  EXPECT_NEAR(motion.cardiac_phase(1.4 + 1e-9), 0, 1e-6);
  scene.duration_s = 10;
  EXPECT_NE(message_of<ConfigError>([&] { heart_motion(scene, 1); }).find("has beats from 9.5 to 14.1 s"),
            std::string::npos);
  scene.motion.beats = "none.csv";
  EXPECT_NE(message_of<InputError>([&] { heart_motion(scene, 1); }).find("none.csv: cannot be read"),
            std::string::npos);
}

TEST(HeartBeats, OfARecordedEcgNeedLabels) {
  const test::TemporaryFolder folder;
  std::string csv = "time_s,ecg\n";
  for (int i = 0; i < 4000; ++i) csv += std::to_string(0.01 * i) + ",0\n";
  folder.write("ecg.csv", csv);
  Scene scene = shipped("pig_2007");
  scene.folder = folder.path();
  scene.ecg.source = "recorded";
  EXPECT_EQ(scene.validate().size(), 1U) << "ecg.record is missing";
  scene.ecg.record = "ecg.csv";
  EXPECT_NE(message_of<ConfigError>([&] { heart_motion(scene, 1); }).find("motion.beats"), std::string::npos);
  scene.duration_s = 100;
  EXPECT_NE(message_of<ConfigError>([&] { heart_motion(scene, 1); }).find("ends at 40 s"), std::string::npos);
  scene.ecg.source = "off";
  EXPECT_EQ(scene.validate().size(), 1U) << "a record that is not used";
}

TEST(HeartBeats, OfARecordedEcgAreDetectedInTheLoop) {
  SKIP_WITHOUT_DATA(test::data("ecg/100.hea"));
  Scene scene = shipped("ecg_recorded");
  scene.ecg.record = test::data("ecg/100.hea").string();
  const auto motion = heart_motion(scene, 1);
  const auto ecg = heart_ecg(scene, motion.beats(), 1);
  const auto s = servo::score_beats(between(detected(*ecg, 30), 0, 29.5), between(motion.beats(), 0, 29.5), 0.05);
  EXPECT_GT(s.labels, 30U);
  EXPECT_EQ(s.matched, s.labels);
  EXPECT_EQ(s.detected, s.labels);
}

// The whole loop: what the predictor is told are detections, late as they are, not the heart's own beats.
TEST(HeartBeats, ReachThePredictorOfALoopAsDetections) {
  struct Spy final : servo::MotionPredictor {
    std::vector<std::pair<double, double>>* told;  // last sample's time, beat
    double now = -1;
    explicit Spy(std::vector<std::pair<double, double>>* t) : told(t) {}
    void observe(const servo::MotionSample& sample) override { now = sample.time_s; }
    void observe_beat(double r_peak_s) override { told->emplace_back(now, r_peak_s); }
    servo::Prediction predict(double) const override { return {}; }
  };
  Scene scene = shipped("ecg_simulated");
  scene.duration_s = 2.4;
  scene.settle_s = 1;
  const auto table = make_table(scene);
  auto stages = make_stages(scene, *table);
  ASSERT_TRUE(stages.ecg);
  std::vector<std::pair<double, double>> told;
  stages.predictor = std::make_unique<Spy>(&told);
  servo::Loop loop(table->frames(), table->robot(), std::move(stages), loop_options(scene, *table),
                   table->marker_to_tip(), [] { return 0.0; });
  const auto picked = table->picked();
  ASSERT_EQ(loop.start(picked.target, picked.marker), "");
  servo::LoopRecord record;
  while (loop.step(record)) {
  }
  std::vector<double> beats;
  for (const auto& [now, beat] : told) {
    beats.push_back(beat);
    if (now >= 0) {
      EXPECT_GT(now + 0.008 - beat, 0.1);
    }
  }
  const auto s = servo::score_beats(between(beats, 0, 2.2), between(table->beats(), 0, 2.2), 0.05);
  EXPECT_GE(s.labels, 2U);
  EXPECT_EQ(s.matched, s.labels);
  EXPECT_GT(s.sigma_error_s, 0) << "detections are not exact";
}

TEST(HeartBeats, ShippedScenesAreValid) {
  for (const char* name : {"ecg_simulated", "ecg_recorded", "rate_variability", "arrhythmia"})
    EXPECT_NO_THROW(shipped(name)) << name;
  Scene recorded = shipped("recorded");
  recorded.ecg.source = "simulated";
  EXPECT_FALSE(recorded.validate().empty());
}

}  // namespace
}  // namespace heartservo::sim
