#include "sim/heart/heart_motion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <numbers>

#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

constexpr double kTau = 2 * std::numbers::pi;

std::complex<double> turn(double cycles) { return {std::cos(kTau * cycles), std::sin(kTau * cycles)}; }

const HeartMotionOptions& checked(const HeartMotionOptions& options) {
  const auto problems = options.validate();
  if (!problems.empty()) throw ConfigError(fmt::format("heart: {}", fmt::join(problems, "; ")));
  return options;
}

PhaseClock respiration_clock(const HeartMotionOptions& o, std::uint64_t seed, double duration_s) {
  // Breaths share nothing with the beats: the seed is spread by an odd constant to draw another sequence.
  const std::uint64_t own = (seed + 1) * 0x9e3779b97f4a7c15ull;
  return {cycle_marks({o.respiration_rate_hz, o.respiration_variability, 0}, duration_s, own),
          1 / o.respiration_rate_hz, 0};
}

std::vector<double> drawn_beats(const HeartMotionOptions& o, std::uint64_t seed, double duration_s) {
  const auto marks = cycle_marks({o.heart_rate_hz, o.beat_variability, o.beat_correlation}, duration_s, seed);
  // ectopic beats have a sequence of their own: without them the others stay as they are
  return plausible_beats(with_ectopic_beats(marks, o.ectopic_share, o.ectopic_advance, seed ^ 0xec70b1cull));
}

}  // namespace

std::vector<std::string> HeartMotionOptions::validate() const {
  std::vector<std::string> problems;
  if (profile != "six_line" && profile != "sharp" && profile != "still" && profile != "sine" && profile != "rail")
    problems.push_back(fmt::format("profile '{}' is not six_line, sharp, still, sine or rail", profile));
  if (!(rail.travel_m >= 0 && rail.period_s > 0 && std::isfinite(rail.travel_m) && rail.turn_rad.allFinite()))
    problems.emplace_back("rail needs a travel_m of 0 or more, a period_s above 0 and a finite turn_rad");
  for (const double value : {heart_rate_hz, respiration_rate_hz})
    if (!(value > 0)) problems.push_back(fmt::format("rate {} Hz is not positive", value));
  if (!(1 / heart_rate_hz > kSystole_s + 0.1))
    problems.push_back(
        fmt::format("heart_rate_hz {} leaves no diastole after {} s of systole", heart_rate_hz, kSystole_s));
  for (const double value : {amplitude_scale, rotation_rad, beat_variability, respiration_variability})
    if (!(value >= 0 && std::isfinite(value)))
      problems.emplace_back("amplitudes and variabilities must not be negative");
  if (!(std::abs(beat_correlation) < 1)) problems.emplace_back("beat_correlation must lie between -1 and 1");
  return problems;
}

HeartMotion::HeartMotion(const HeartMotionOptions& options, std::uint64_t seed, double duration_s)
    : HeartMotion(options, seed, duration_s, drawn_beats(checked(options), seed, duration_s)) {}

HeartMotion::HeartMotion(const HeartMotionOptions& options, std::uint64_t seed, double duration_s,
                         std::vector<double> r_peaks_s)
    : options_(checked(options)),
      heart_(plausible_beats(std::move(r_peaks_s)), 1 / options.heart_rate_hz, kSystole_s),
      respiration_(respiration_clock(options, seed, duration_s)) {
  const bool beats = options_.profile == "six_line" || options_.profile == "sharp";
  if (beats) harmonics_ = options_.profile == "sharp" ? profile::kCardiacLines : 4;
  const double scale = beats ? options_.amplitude_scale : 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < 6; ++i) {
      const double amplitude = scale * profile::kAmplitude_m[axis] * std::sqrt(profile::kDensityPercent[axis][i] / 100);
      (i < 2 ? respiration_lines_[axis][i] : heart_lines_[axis][i - 2]) = amplitude * turn(profile::kPhase[axis][i]);
    }
    for (int n = 5; n <= profile::kCardiacLines; ++n) {
      const double omega = kTau * profile::kHeartRate_hz * n;
      const double amplitude = axis == 2 ? scale * profile::kSharpAcceleration / (omega * omega) : 0;
      heart_lines_[axis][n - 1] = amplitude * turn(profile::kSharpPhase[n - 5]);
    }
  }
}

double HeartMotion::strength(const std::complex<double>& breath) const {
  // In step with the respiration's displacement along z.
  return harmonics_ == 0 ? 0 : 1 + options_.breathing_modulation * std::real(breath * turn(profile::kPhase[2][0]));
}

double HeartMotion::beat_strength(double t) const { return strength(turn(respiration_phase(t))); }

Eigen::Vector3d HeartMotion::displacement(double t) const {
  if (on_rail()) {
    const double way = t / options_.rail.period_s, there = 2 * std::abs(way - std::floor(way + 0.5));
    return {0, 0, options_.rail.travel_m * (there - 0.5)};
  }
  if (options_.profile == "sine")
    return options_.sine_amplitude_m * std::sin(kTau * options_.sine_hz * t) *
           Eigen::Vector3d::Unit(options_.sine_axis);
  const std::complex<double> breath = turn(respiration_phase(t));
  const std::complex<double> beat = turn(cardiac_phase(t));
  const double beat_gain = strength(breath);
  Eigen::Vector3d breathing, beating = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis)
    breathing(axis) = std::real(breath * (respiration_lines_[axis][0] + breath * respiration_lines_[axis][1]));
  std::complex<double> harmonic = beat;
  for (int n = 0; n < harmonics_; ++n, harmonic *= beat)
    for (int axis = 0; axis < 3; ++axis)
      beating(axis) += harmonic.real() * heart_lines_[axis][n].real() - harmonic.imag() * heart_lines_[axis][n].imag();
  return breathing + beat_gain * beating;
}

Eigen::Matrix3d HeartMotion::rotation(double t) const {
  if (on_rail()) {
    const double turn = options_.rail.turn_rad.norm();
    if (turn < 1e-12) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(turn, options_.rail.turn_rad / turn).toRotationMatrix();
  }
  const double breath = kTau * respiration_phase(t);
  const double beat = kTau * cardiac_phase(t);
  const double amplitude = harmonics_ == 0 ? 0 : options_.rotation_rad * options_.amplitude_scale;
  // Breathing tilts the heart, the beat twists it; the shares of each axis add up to 1.
  const Eigen::Vector3d w(0.65 * std::sin(breath + 0.4) + 0.35 * std::sin(beat + 1.1),
                          0.45 * std::sin(breath + 2.0) + 0.55 * std::sin(beat + 2.9),
                          0.30 * std::sin(breath + 4.1) + 0.70 * std::sin(beat + 0.2));
  const double angle = amplitude * w.norm();
  if (angle < 1e-12) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w.normalized()).toRotationMatrix();
}

}  // namespace heartservo::sim
