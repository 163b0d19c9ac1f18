#pragma once
// Motions made as the project's reference records were: the lines of sim::profile (six_line or sharp), beats whose
// periods vary from one to the next (correlation 0.3), systole of 0.35 s at the nominal rate and a diastole that is
// stretched evenly, breathing at a constant rate that modulates the beat by 10 %, 125 Hz, noise 0.01, 0.01 and 0.05 mm.
// Unlike sim::HeartMotion the phase's rate jumps where systole ends.
#include <Eigen/Core>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "servo/motion/motion_record.hpp"
#include "sim/heart/beats.hpp"
#include "sim/heart/heart_profile.hpp"

namespace heartservo::test {

struct ReferenceMotion {
  bool sharp = false;
  double beat_variability = 0.02;
  double heart_rate_hz = sim::profile::kHeartRate_hz;
  double respiration_hz = 0.34;
  double breath_phase = 0;  // cycles, at time 0
  double noise_scale = 1;
  std::vector<double> r_peaks_s;  // drawn where empty

  /// The phase of the heart, cycles.
  double beat_phase(double t) const {
    const double period = 1 / heart_rate_hz, systole = std::min(sim::kSystole_s, 0.7 * period);
    const auto next = std::upper_bound(r_peaks_s.begin(), r_peaks_s.end(), t);
    if (next == r_peaks_s.begin() || next == r_peaks_s.end()) return (t - r_peaks_s.front()) / period;
    const double since = t - *(next - 1), length = *next - *(next - 1);
    if (since < systole) return since / period;
    return (systole + (since - systole) * (period - systole) / (length - systole)) / period;
  }

  Eigen::Vector3d position(double t) const {
    using namespace sim::profile;
    const auto turn = [](double cycles) { return std::polar(1.0, 2 * std::numbers::pi * cycles); };
    const std::complex<double> breath = turn(respiration_hz * t + breath_phase), beat = turn(beat_phase(t));
    const double gain = 1 + 0.1 * std::real(breath * turn(kPhase[2][0]));
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto line = [&](std::size_t i) {
        return kAmplitude_m[axis] * std::sqrt(kDensityPercent[axis][i] / 100) * turn(kPhase[axis][i]);
      };
      const auto i = static_cast<Eigen::Index>(axis);
      p[i] = std::real(breath * line(0)) + std::real(breath * breath * line(1));
      std::complex<double> z = 1;
      for (std::size_t n = 0; n < 4; ++n) p[i] += gain * std::real((z *= beat) * line(n + 2));
      if (!sharp || axis < 2) continue;
      for (std::size_t n = 5; n <= kCardiacLines; ++n) {
        const double omega = 2 * std::numbers::pi * kHeartRate_hz * static_cast<double>(n);
        p[i] += gain * std::real((z *= beat) * turn(kSharpPhase[n - 5])) * kSharpAcceleration / (omega * omega);
      }
    }
    return p;
  }
};

/// `motion` with beats drawn from `seed` unless it has some.
inline ReferenceMotion drawn(ReferenceMotion motion, double duration_s, std::uint64_t seed) {
  motion.breath_phase = static_cast<double>(seed % 17) / 17;
  if (motion.r_peaks_s.empty())
    motion.r_peaks_s = sim::cycle_marks({motion.heart_rate_hz, motion.beat_variability, 0.3}, duration_s + 2, seed);
  return motion;
}

inline servo::MotionRecord recorded(const ReferenceMotion& motion, double duration_s, std::uint64_t seed,
                                    double period_s = 0.008) {
  std::mt19937_64 random(seed * 2654435761u + 17);
  std::normal_distribution<double> normal;
  servo::MotionRecord record;
  record.file = "reference motion";
  record.group = "measured";
  for (int k = 0; k * period_s < duration_s; ++k) {
    const double t = k * period_s;
    const Eigen::Vector3d p = motion.position(t);
    const double scale = motion.noise_scale;
    record.time_s.push_back(t);
    record.truth.push_back(p);
    record.measured.push_back(
        p + scale * Eigen::Vector3d(1e-5 * normal(random), 1e-5 * normal(random), 5e-5 * normal(random)));
    record.line.push_back(k + 2);
  }
  return record;
}

}  // namespace heartservo::test
