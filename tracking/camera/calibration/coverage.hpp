#pragma once
// Where a calibration has seen the board, in the picture and in the volume where the camera is to work. Outside, the
// camera is extrapolated.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "tracking/camera/calibration/board.hpp"

namespace heartservo::tracking {

/// Points per cell of a grid over the picture, row by row; cells are about square.
struct PictureCoverage {
  int columns = 0, rows = 0;
  std::vector<int> points;

  double share() const;  ///< of the cells, that have a point
  int at(int column, int row) const { return points[static_cast<std::size_t>(row * columns + column)]; }

  /// Parts of the picture (a third of it each way) of which less than half the cells have a point: "top left".
  std::vector<std::string> missing_parts() const;
};
PictureCoverage picture_coverage(int width, int height, const std::vector<Corners>& views);

/// The volume where the heart is, in the camera frame; by default the paper's (section 2.1).
struct WorkingVolume {
  Eigen::Vector3d size_m{0.020, 0.015, 0.015};  ///< x, y, z
  double distance_m = 0.055;                    ///< of its centre from the camera (the endoscope's tip), along z
  double cell_m = 0.005;                        ///< about; a whole number of cells fits each side

  std::string description() const;  ///< "20 x 15 x 15 mm at 55 mm"
};

struct VolumeCoverage {
  Eigen::Vector3i cells = Eigen::Vector3i::Zero();
  std::vector<int> points;  ///< x fastest, then y, then z

  double share() const;
  double share_of_slice(int z) const;
  int at(int x, int y, int z) const { return points[static_cast<std::size_t>((z * cells.y() + y) * cells.x() + x)]; }
};

/// `points` of the board in the camera frame (m), from all views.
VolumeCoverage volume_coverage(const WorkingVolume& volume, const std::vector<Eigen::Vector3d>& points);

}  // namespace heartservo::tracking
