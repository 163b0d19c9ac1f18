#pragma once
// The motion of a point over time, as a file holds it: what `heartservo predict` and `heartservo analyse` work on.
//
// CSV with `time_s` and three columns GROUP/x_m, GROUP/y_m, GROUP/z_m, and optionally truth/x_m ... beside it; other
// columns are ignored, so that frames.csv of `heartservo track` and `servo` can be read as it is. Or a trajectory in
// TUM format: `time x y z qx qy qz qw` a line. Or a folder that `track` or `servo` left, whose frames.csv is read.
#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace heartservo::servo {

/// Something odd that the record can be used with: "FILE:LINE: what".
using RecordNotes = std::vector<std::string>;

struct MotionRecord {
  std::string file;                       ///< as read: frames.csv of a run folder
  std::string group;                      ///< "measured", "point3"; "" of a TUM file
  std::vector<double> time_s;             ///< strictly increasing, two or more
  std::vector<int> line;                  ///< in the file, from 1
  std::vector<Eigen::Vector3d> position;  ///< m; NaN in all axes where the row has none
  std::vector<Eigen::Vector3d> truth;     ///< m, the same way; empty when the file has none, or is the group itself
  double period_s = 0;                    ///< median step of time
  RecordNotes notes;                      ///< gaps in time, rows without a position, axes that stand still

  std::size_t rows() const { return time_s.size(); }
  bool has_truth() const { return !truth.empty(); }
  double duration_s() const { return time_s.back() - time_s.front(); }
};

/// Reads `path`. `group`: the columns to read; "" for `measured`, or the only group that there is. Throws InputError,
/// naming file and line: not readable, no such columns, a cell that is no finite number, time that does not increase,
/// fewer than two rows with a position. Throws ConfigError for a `group` that the file does not have, or when there are
/// several to choose from.
MotionRecord read_motion(const std::filesystem::path& path, const std::string& group = "");

/// Times of beats (R peaks), s, strictly increasing: the column time_s of a CSV file.
/// Throws InputError with file and line.
std::vector<double> read_beats(const std::filesystem::path& file);

}  // namespace heartservo::servo
