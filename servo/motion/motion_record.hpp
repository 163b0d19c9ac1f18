#pragma once
// A motion on disk: CSV with `time_s` and three positions a row, in metres. Columns `measured/x_m, measured/y_m,
// measured/z_m` and optionally `truth/x_m, ...`; or any other group `NAME/x_m, ...`, chosen by name; frames.csv of
// `heartservo track` and `servo` are such files. Or a trajectory in TUM format (.tum). Or the folder of a run, which
// has a frames.csv.
#include <Eigen/Core>
#include <string>
#include <vector>

namespace heartservo::servo {

struct MotionRecord {
  std::string file, group;                ///< where it is from
  std::vector<double> time_s;             ///< strictly increasing
  std::vector<Eigen::Vector3d> measured;  ///< m; a row without a position is NaN in all three
  std::vector<Eigen::Vector3d> truth;     ///< m, as measured; empty where the file has none
  std::vector<int> line;                  ///< of each row, in the file
  /// What is odd but usable, each one line with file and line number: gaps, rows without a position, an axis that never
  /// moves.
  std::vector<std::string> warnings;

  /// The median time between rows, s.
  double period_s() const;
};

/// `group`: "" for `measured`, or where there is no such group, the file's only one; truth where there is nothing else.
/// Throws InputError with file and line: missing or misspelt columns, time that does not go on, half a position,
/// infinite numbers, less than two rows; ConfigError when the file has no group of that name, or several and none is
/// chosen.
MotionRecord read_motion_record(const std::string& path, const std::string& group = "");

/// Times of R peaks, s: a CSV with the column `time_s`, strictly increasing. Throws InputError with file and line.
std::vector<double> read_beats(const std::string& file);

}  // namespace heartservo::servo
