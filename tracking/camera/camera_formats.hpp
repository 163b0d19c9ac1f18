#pragma once
// The readers behind read_camera_file() and the writers behind write_camera(), one file a format. Readers throw
// InputError naming file and key.
#include <string>
#include <vector>

#include "tracking/camera/camera_file.hpp"

namespace YAML {
class Node;
}

namespace heartservo::tracking {

/// ROS camera_info; `root` is the map that the file holds.
CameraFile read_ros_camera(const YAML::Node& root, const std::string& file);
std::string ros_text(const WideCamera& camera, const std::string& name);

/// OpenCV FileStorage; `text` is the content of `file`.
CameraFile read_opencv_camera(const std::string& text, const std::string& file);
std::string opencv_text(const WideCamera& camera, bool xml);

/// ViSP XML; `text` is the content of `file`.
CameraFile read_visp_camera(const std::string& text, const std::string& file);
/// k1 becomes kud; kdu is the way back (camera_fit.hpp).
std::string visp_text(const Camera& camera, double kdu, const std::string& name);

/// True for text that assigns fc, as Calib_Results.m does.
bool is_matlab_camera(const std::string& text);
CameraFile read_matlab_camera(const std::string& text, const std::string& file);
std::string matlab_text(const WideCamera& camera);

/// Sets fx, fy, cx, cy and skew from the nine elements of K, row by row. Throws InputError (`key` at `where`) for
/// another size, numbers that are not finite, or another form.
void set_matrix(CameraFile& camera, const std::vector<double>& K, const std::string& where, const std::string& key);

/// Sets k1..k5 from k1 k2 p1 p2 [k3 and further terms, which must be zero]. Throws InputError (`key` at `where`).
void set_distortion(CameraFile& camera, const std::vector<double>& k, const std::string& where, const std::string& key);

/// Writes `text` to `file` in one piece. Throws InputError.
void write_whole_file(const std::string& file, const std::string& text);

}  // namespace heartservo::tracking
