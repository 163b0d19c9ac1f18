#pragma once
// What the paper's section 4.3 reports of a motion: spectrum, lines, respiration, velocity, acceleration.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "servo/motion/motion_lines.hpp"
#include "servo/motion/uniform_motion.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::servo {

struct AnalysisOptions {
  double segment_s = 20;       ///< of the spectrum; a shorter record is one segment
  double split_hz = 0;         ///< respiration lies below; 0: 1 Hz, or less where the heart is slower
  double cutoff_hz = 0;        ///< of velocity and acceleration; 0: chosen per axis
  double least_percent = 0.1;  ///< lines weaker than this share of every axis are not listed
  double edge_s = 0.5;         ///< the ends left out of extremes and deviations

  std::vector<std::string> validate() const;
};

/// Along one axis of the camera frame.
struct AxisAnalysis {
  double mean_m = 0, rms_m = 0, peak_to_peak_m = 0;  ///< RMS about the mean
  double respiration_peak_to_peak_m = 0;             ///< of what lies below the split
  double beat_peak_to_peak_m = 0;                    ///< of the rest, below the cut-off
  double noise_m = 0;        ///< standard deviation of white noise at the level of the spectrum's upper end
  double noise_density = 0;  ///< m^2/Hz, one-sided
  double cutoff_hz = 0;      ///< of velocity and acceleration
  double max_velocity = 0, max_acceleration = 0;      ///< m/s, m/s^2; largest amounts
  double velocity_sigma = 0, acceleration_sigma = 0;  ///< standard deviations that the noise leaves in them
  double in_lines_percent = 0;                        ///< of the power, in the lines listed
};

struct MotionAnalysis {
  UniformMotion motion;
  std::array<Spectrum, 3> spectra;
  Rhythm rhythm;
  std::vector<MotionLine> lines;
  double split_hz = 0;
  std::array<AxisAnalysis, 3> axis;
  /// Series on the grid of `motion`, per axis: m, m, m/s, m/s^2.
  std::array<std::vector<double>, 3> respiration, beat, velocity, acceleration;
  std::vector<std::string> notes;  ///< what a reader should know, one line each
};

/// Throws InputError, naming the file: shorter than kShortestRecord_s, standing still along every axis, gaps too long.
MotionAnalysis analyse(const MotionRecord& record, const std::vector<Eigen::Vector3d>& positions,
                       const AnalysisOptions& options);

/// Two breaths of a ventilator at 12 cycles per minute.
inline constexpr double kShortestRecord_s = 10;

}  // namespace heartservo::servo
