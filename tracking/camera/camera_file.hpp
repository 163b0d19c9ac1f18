#pragma once
// Calibrations on disk. Reads the three families that people have; writes ROS camera_info YAML.
#include <string>

#include "tracking/camera/camera.hpp"

namespace heartservo::tracking {

/// Reads a calibration; the format is told from the content, not from the name:
///   - ROS camera_info YAML, distortion_model plumb_bob;
///   - OpenCV FileStorage YAML or XML: camera_matrix / distortion_coefficients and their usual other names, the left
///     camera of a stereo file (LEFT.K, LEFT.D), ORB-SLAM's Camera.fx ... (LEFT.K first: it is the picture as taken);
///   - ViSP XML (vpXmlParserCamera): one camera, kud becomes k1.
/// Throws InputError naming file and key: missing, not finite, of the wrong size, a model that eq. 3 and 4 cannot hold
/// (a third radial term, fish-eye), or numbers that Camera::validate() refuses.
Camera read_camera(const std::string& file);

/// Writes ROS camera_info YAML, rectification (identity) and projection matrix included. The file appears under its
/// name only when complete. Throws InputError: a camera that validate() refuses, or a file that cannot be written.
void write_ros_camera(const Camera& camera, const std::string& file, const std::string& name);

}  // namespace heartservo::tracking
