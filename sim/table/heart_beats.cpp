#include "sim/table/heart_beats.hpp"

#include <fmt/format.h>

#include "servo/ecg/ecg_record.hpp"
#include "sim/heart/ecg_signal.hpp"
#include "sim/scene/scene.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {

namespace {

constexpr double kPastTheEnd_s = 1;

servo::EcgRecord recorded(const Scene& scene) {
  servo::EcgRecord record = servo::read_ecg(resolve(scene, scene.ecg.record), scene.ecg.lead);
  const double end = record.start_s + record.duration_s(), needed = scene.ecg.start_s + scene.duration_s;
  if (!scene.is_recorded() && end < needed)
    throw ConfigError(fmt::format("{}: ends at {:.4g} s; the run needs it up to ecg.start_s + duration_s = {:.4g} s",
                                  record.file, end, needed));
  return record;
}

std::vector<double> beats_of_files(const Scene& scene) {
  std::string file = scene.motion.beats.empty() ? "" : resolve(scene, scene.motion.beats);
  double rate_hz = scene.motion.beats_rate_hz;
  if (scene.ecg.source == "recorded") {
    const servo::EcgRecord record = recorded(scene);
    rate_hz = record.rate_hz;
    if (file.empty()) file = annotations_of(record);
    if (file.empty())
      throw ConfigError(fmt::format(
          "{}: has no labels (.atr) beside it for the heart to beat by; name a file of R peaks by motion.beats",
          record.file));
  }
  std::vector<double> beats = servo::read_annotated_beats(file, rate_hz);
  for (double& beat : beats) beat -= scene.ecg.start_s;
  if (beats.front() > 0 || beats.back() < scene.duration_s)
    throw ConfigError(
        fmt::format("{}: has beats from {:.4g} to {:.4g} s; the run needs them from ecg.start_s = {:.4g} s to {:.4g} s",
                    file, beats.front() + scene.ecg.start_s, beats.back() + scene.ecg.start_s, scene.ecg.start_s,
                    scene.ecg.start_s + scene.duration_s));
  std::erase_if(beats, [&](double beat) { return beat < -scene.ecg.lead_in_s - 5 || beat > scene.duration_s + 5; });
  return beats;
}

}  // namespace

HeartMotion heart_motion(const Scene& scene, std::uint64_t seed) {
  const double duration = scene.duration_s + kPastTheEnd_s;
  if (scene.motion.beats.empty() && scene.ecg.source != "recorded") return {scene.motion, seed, duration};
  return {scene.motion, seed, duration, beats_of_files(scene)};
}

std::unique_ptr<servo::EcgSource> heart_ecg(const Scene& scene, const std::vector<double>& beats, std::uint64_t seed) {
  if (scene.ecg.source == "simulated") return make_simulated_ecg(scene.ecg, beats, seed);
  if (scene.ecg.source == "recorded") return make_recorded_ecg(scene.ecg, recorded(scene));
  return nullptr;
}

}  // namespace heartservo::sim
