#pragma once
// Where surface points of a recorded sequence lie in its pictures, as found by hand or by another program: what
// recorded sequences are scored against.
#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "tracking/planar/quad.hpp"

namespace heartservo::sim {

/// One point through the sequence; px, (0, 0) is the centre of the top left pixel.
struct PointTrack {
  std::string name;      ///< "" where the file names none
  bool by_frame = true;  ///< `when` counts frames from 1, else it is time in s
  std::vector<double> when;
  std::vector<Eigen::Vector2d> px;  ///< NaN where the point is not visible

  /// By frame: of that frame alone. By time: linear between rows; NaN where one of the two is. NaN outside the rows.
  /// `sequence` counts from 0.
  Eigen::Vector2d at(std::uint64_t sequence, double time_s) const;
};

/// CSV with columns `frame` (1 is the first) or `time_s`, and `u_px`, `v_px`; and, where there are several points,
/// `point` (a name). Rows whose `visible` is 0, or whose px are empty, do not count. Other columns are ignored.
class PointTracks {
 public:
  /// Throws InputError with file and line.
  static PointTracks read(const std::string& file);

  const std::string& file() const { return file_; }
  const std::vector<PointTrack>& points() const { return points_; }

  /// The point called `name`; or, for "", the one whose place in the first frame is inside the region and nearest to
  /// its centre. A file's only, unnamed point need not be visible there. Throws ConfigError: unknown name, not visible
  /// in the first frame, or outside the region.
  const PointTrack& choose(const std::string& name, const tracking::Quad& region) const;

 private:
  std::string file_;
  std::vector<PointTrack> points_;
};

}  // namespace heartservo::sim
