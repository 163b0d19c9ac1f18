#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

namespace heartservo::sim {

/// An independent record of where the region's centre is in the picture: CSV with the header time_s,u_px,v_px; rows in
/// order of time. For the score of recorded sequences.
class ReferenceTrack {
 public:
  /// Throws InputError with file and line.
  static ReferenceTrack read(const std::string& file);

  /// Linear between rows; NaN outside them, and where the nearest rows are empty cells.
  Eigen::Vector2d at(double time_s) const;

  const std::string& file() const { return file_; }

 private:
  std::string file_;
  std::vector<double> time_s_;
  std::vector<Eigen::Vector2d> points_;
};

}  // namespace heartservo::sim
