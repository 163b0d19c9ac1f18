#pragma once
// A stereo endoscope: two cameras and where they stand to each other.
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "tracking/camera/camera.hpp"

namespace heartservo::tracking {

struct StereoCamera {
  Camera left, right;
  Eigen::Isometry3d T_right_left = Eigen::Isometry3d::Identity();  ///< m; a point of the left frame into the right

  double baseline_m() const { return T_right_left.translation().norm(); }

  /// Every problem at once: those of either camera, another size of picture, a baseline that no endoscope has (0.1 mm
  /// to 0.5 m).
  std::vector<std::string> validate() const;
};

/// OpenCV FileStorage (YAML or XML) with the names of OpenCV's stereo calibration: image_width, image_height, M1, D1,
/// M2, D2, R, T (x_right = R x_left + T), T in the unit that `length_unit` says ("m" or "mm"; m where it is missing).
/// read_camera() reads the left camera of it. Throws InputError naming file and key.
StereoCamera read_stereo_camera(const std::string& file);

/// Throws InputError: validate() refuses it, or the file cannot be written.
void write_stereo_camera(const StereoCamera& stereo, const std::string& file);

/// True for a file with M2, so that it can be told from a single camera's.
bool is_stereo_file(const std::string& file);

}  // namespace heartservo::tracking
