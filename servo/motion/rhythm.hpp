#pragma once
// The two rhythms of a heart's motion, found without knowing either: heartbeat and breathing.
#include <array>

#include "servo/motion/spectrum.hpp"
#include "servo/motion/uniform_motion.hpp"

namespace heartservo::servo {

/// Where they are looked for.
inline constexpr double kLowestHeart_hz = 0.6, kHighestHeart_hz = 3.2;
inline constexpr double kLowestRespiration_hz = 0.08, kHighestRespiration_hz = 0.75;

struct Rhythm {
  double heart_hz = 0, respiration_hz = 0;  ///< mean over the record; 0: not found
};

/// `spectra`: welch() of each axis of `motion`.
Rhythm find_rhythm(const UniformMotion& motion, const std::array<Spectrum, 3>& spectra);

/// The mean frequency of a family of lines near f, 2 f, ... over the whole record, from the mean turn of each band's
/// analytic signal from sample to sample ("pulse pair"), weighted by power. `f` must be right to about a tenth.
/// `harmonics`: how many are used; `half_width`: of their bands, relative to f (below 0.5).
double mean_frequency(const UniformMotion& motion, double f, int harmonics, double half_width);

}  // namespace heartservo::servo
