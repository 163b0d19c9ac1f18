#pragma once
// The readers behind read_camera(), one file each. All throw InputError naming file and key.
#include <string>
#include <vector>

#include "tracking/camera/camera.hpp"

namespace YAML {
class Node;
}

namespace heartservo::tracking {

/// ROS camera_info; `root` is the map that the file holds.
Camera read_ros_camera(const YAML::Node& root, const std::string& file);

/// OpenCV FileStorage; `text` is the content of `file`.
Camera read_opencv_camera(const std::string& text, const std::string& file);

/// ViSP XML; `text` is the content of `file`.
Camera read_visp_camera(const std::string& text, const std::string& file);

/// Sets fx, fy, cx, cy from the nine elements of K, row by row. Throws InputError (`key` at `where`) for another size,
/// skew, or a last row that is not 0 0 1.
void set_matrix(Camera& camera, const std::vector<double>& K, const std::string& where, const std::string& key);

/// Sets k1..k4 from k1 k2 p1 p2 [further terms, which must be zero]. Throws InputError (`key` at `where`).
void set_distortion(Camera& camera, const std::vector<double>& k, const std::string& where, const std::string& key);

}  // namespace heartservo::tracking
