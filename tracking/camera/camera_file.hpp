#pragma once
// Calibrations on disk: ROS, OpenCV, ViSP, Matlab.
#include <optional>
#include <string>
#include <vector>

#include "tracking/camera/camera.hpp"
#include "tracking/camera/wide_camera.hpp"

namespace heartservo::tracking {

enum class CameraFormat {
  ROS,     ///< camera_info YAML, plumb_bob
  OPENCV,  ///< FileStorage YAML or XML
  VISP,    ///< vpXmlParserCamera XML
  MATLAB   ///< Bouguet's Calib_Results.m
};

/// "ros", "opencv", "visp", "matlab".
std::string name_of(CameraFormat format);
const std::vector<std::string>& camera_format_names();

/// Throws ConfigError with a suggestion.
CameraFormat camera_format(const std::string& name);

/// What the name of a file to write asks for: .m matlab, .xml visp, .yaml and .yml ros; nothing for others.
std::optional<CameraFormat> format_of_name(const std::string& file);

struct CameraFile {
  WideCamera camera;
  CameraFormat format = CameraFormat::ROS;
  std::string beyond;  ///< "FILE: KEY: what eq. 1-4 cannot hold", "" where they say it all
};

/// Reads a calibration; the format is told from the content, not from the name:
///   - ROS camera_info YAML, distortion_model plumb_bob;
///   - OpenCV FileStorage YAML or XML: camera_matrix / distortion_coefficients and their usual other names, the left
///     camera of a stereo file (LEFT.K, LEFT.D, M1, D1), ORB-SLAM's Camera.fx ... (LEFT.K first: it is the picture as
///     taken);
///   - ViSP XML (vpXmlParserCamera): one camera, kud becomes k1;
///   - Matlab calibration toolbox (Bouguet), Calib_Results.m: fc, cc, alpha_c, kc, nx, ny.
/// All have pixel (0, 0) at the centre of the top-left pixel. Throws InputError naming file and key: missing, not
/// finite, of the wrong size, a model that WideCamera cannot hold (fish-eye, rational), or numbers that validate()
/// refuses.
CameraFile read_camera_file(const std::string& file);

/// The same for the model of eq. 1-4. Throws InputError also for a third radial term and for skew.
Camera read_camera(const std::string& file);

/// Writes the file in one piece: it appears under its name only when complete. `camera` must have only the terms that
/// the format can hold (camera_fit.hpp makes one). `kdu` is ViSP's way back; by default that of `camera`. Throws
/// InputError: a camera that validate() refuses, a file that cannot be written. OPENCV writes XML for a name that ends
/// in .xml, else YAML.
void write_camera(const WideCamera& camera, CameraFormat format, const std::string& file, const std::string& name,
                  std::optional<double> kdu = std::nullopt);

/// write_camera() as ROS.
void write_ros_camera(const Camera& camera, const std::string& file, const std::string& name);

}  // namespace heartservo::tracking
