#pragma once
// The heart of the paper's section 4.3 as a sum of lines: Table 3 (densities), Table 4 (accelerations).
//
// Table 3's densities are read as shares of *power*, so that a line's amplitude goes with the square root of its
// density. The overall amplitudes are 11 mm peak to peak along z (section 4.3) and, along x and y, which the paper does
// not print, those that give Table 4's accelerations with Table 3's lines. RMS 2.6, 1.6 and 2.7 mm, peak to peak 10.7,
// 6.6 and 11 mm; the project's reference records (six_line_*) have RMS 2.65-2.98, 1.41-1.76 and 2.60-2.86 mm, peak to
// peak 11.5-12.4, 6.6-8.4 and 11.2-11.7 mm.
//
// The phases are free (the paper prints none). They were chosen, by random search, so that the peaks come out as
// printed and so that the largest accelerations fall into systole, where the beat's length does not change them.
#include <array>
#include <cmath>

namespace heartservo::sim::profile {

inline constexpr int kCardiacLines = 12;  ///< harmonics of the heart: 4 in Table 3, 8 more in the sharp profile

/// Shares of power, in percent: respiration and its second harmonic, then the heart's first four.
inline constexpr std::array<std::array<double, 6>, 3> kDensityPercent{
    {{8.7, 0, 21.8, 60, 2.8, 6.7}, {3.9, 1.9, 45.6, 33, 3.9, 11.7}, {70.9, 11.5, 5.9, 8.7, 1.2, 1.8}}};

/// sqrt(2) times the RMS of each axis, m.
inline constexpr std::array<double, 3> kAmplitude_m{3.71e-3, 2.20e-3, 3.75e-3};

/// Phases of the six lines, in cycles.
inline constexpr std::array<std::array<double, 6>, 3> kPhase{
    {{0.93, 0.47, 0.65, 0.89, 0.82, 0.48}, {0.30, 0.28, 0.70, 0.86, 0.81, 0.47}, {0.41, 0.70, 0.12, 0.45, 0.15, 0.06}}};

/// The sharp profile's further lines, harmonics 5 to 12 along z: each contributes the same acceleration (m/s^2), which
/// makes 0.26 mm of the 5th (0.5 % of the density) and 0.04 mm of the 12th.
inline constexpr double kSharpAcceleration = 0.36;
inline constexpr std::array<double, 8> kSharpPhase{0.78, 0.32, 0.20, 0.95, 0.61, 0.47, 0.05, 0.85};

/// The rates of Table 3 at which the amplitudes above hold.
inline constexpr double kHeartRate_hz = 1.19;
inline constexpr double kRespiration_hz = 1.0 / 3;  ///< ventilator at 20 cycles per minute (section 4.2)

}  // namespace heartservo::sim::profile
