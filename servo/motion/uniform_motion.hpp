#pragma once
// A motion on an even grid of time, as spectra and filters need it.
#include <array>
#include <string>
#include <vector>

#include "servo/motion/motion_record.hpp"

namespace heartservo::servo {

struct UniformMotion {
  double start_s = 0, rate_hz = 0;
  std::array<std::vector<double>, 3> axis;  ///< x, y, z in m, all of the same length
  std::size_t filled = 0;                   ///< samples that had to be interpolated over gaps

  std::size_t size() const { return axis[0].size(); }
  double time_s(std::size_t i) const { return start_s + static_cast<double>(i) / rate_hz; }
  double duration_s() const { return static_cast<double>(size() - 1) / rate_hz; }
};

/// The longest time without a position that is bridged: a fraction of a heartbeat.
inline constexpr double kLongestBridge_s = 0.3;

/// `positions` (record.measured or record.truth) from the first known to the last at the record's median period; what
/// lies between rows, or in gaps up to kLongestBridge_s, is interpolated by cubics (Catmull-Rom on uneven times).
/// Throws InputError with file and line for a longer gap, and where fewer than four positions are known.
UniformMotion uniform_motion(const MotionRecord& record, const std::vector<Eigen::Vector3d>& positions);

}  // namespace heartservo::servo
