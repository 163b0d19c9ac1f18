#pragma once
// The lines of a motion's spectrum, named: what the paper's Table 3 lists.
#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "servo/motion/rhythm.hpp"

namespace heartservo::servo {

struct MotionLine {
  enum class Family { RESPIRATION, HEART, SIDEBAND, OTHER };
  Family family = Family::OTHER;
  int harmonic = 0;  ///< 1: the fundamental; of a sideband: the heart's harmonic beside which it lies
  int breaths = 0;   ///< of a sideband: how many times the respiration's frequency it lies beside it; -1, 1, ...
  double frequency_hz = 0;
  double low_hz = 0, high_hz = 0;  ///< the band that counts as this line
  /// Of the sine with the line's power, m. The level of noise is taken off.
  Eigen::Vector3d amplitude_m = Eigen::Vector3d::Zero();
  /// Share of the power of all lines of the axis, %.
  Eigen::Vector3d density_percent = Eigen::Vector3d::Zero();
};

/// "heart 2", "respiration 1", "heart 1 - respiration 1", "other".
std::string name_of(const MotionLine& line);

/// By frequency. Harmonics up to 12 of each family and other lines, as far as they stand out of the noise and have
/// `least_percent` of an axis' power. Every frequency from half the first line's to half a beat above the last one
/// belongs to the line nearest to it, so that lines widened by an uneven heart keep their power.
std::vector<MotionLine> find_lines(const Rhythm& rhythm, const std::array<Spectrum, 3>& spectra,
                                   const Eigen::Vector3d& noise_density, double least_percent);

}  // namespace heartservo::servo
