#include "tracking/camera/camera_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tracking/camera/camera_fit.hpp"
#include "tracking/camera/camera_formats.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::tracking {

namespace {

constexpr std::uintmax_t LARGEST_FILE = 4'000'000;  // bytes; a calibration with all its board views is far smaller

std::string read_text(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(file + ": no such file; check the path");
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError(file + ": is not a file; name a calibration file");
  if (std::filesystem::file_size(file, error) > LARGEST_FILE)
    throw InputError(file + ": is too large for a calibration; expected a ROS, OpenCV, ViSP or Matlab camera file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file + ": cannot be read; check its permissions");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    throw InputError(file + ": is empty; expected a ROS, OpenCV, ViSP or Matlab camera file");
  if (text.find('\0') != std::string::npos)
    throw InputError(file + ": is not a text file; expected a ROS, OpenCV, ViSP or Matlab camera file");
  return text;
}

// OpenCV's dialect of YAML (its header, its matrix tag, ORB-SLAM's dotted keys) is not always YAML.
bool is_opencv_yaml(const std::string& text) {
  for (const char* sign : {"%YAML:", "!!opencv-matrix", "\nCamera.fx", "\nCamera1.fx", "\nLEFT.K"})
    if (("\n" + text).find(sign) != std::string::npos) return true;
  return false;
}

CameraFile read_any(const std::string& text, const std::string& file) {
  if (text[text.find_first_not_of(" \t\r\n\xEF\xBB\xBF")] == '<')
    return text.find("<opencv_storage") != std::string::npos ? read_opencv_camera(text, file)
                                                             : read_visp_camera(text, file);
  if (is_matlab_camera(text)) return read_matlab_camera(text, file);
  if (is_opencv_yaml(text)) return read_opencv_camera(text, file);
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& e) {
    throw InputError(fmt::format("{}:{}: is no camera file that can be read: {}", file, e.mark.line + 1, e.msg));
  }
  if (!root.IsMap()) throw InputError(file + ": holds no keys; expected a ROS, OpenCV, ViSP or Matlab camera file");
  return read_ros_camera(root, file);
}

void check(const WideCamera& camera, const std::string& file) {
  const auto problems = camera.validate();
  if (!problems.empty())
    throw InputError(fmt::format("{}: not a usable camera: {}; calibrate again", file, fmt::join(problems, "; ")));
}

}  // namespace

std::string name_of(CameraFormat format) { return camera_format_names()[static_cast<std::size_t>(format)]; }

const std::vector<std::string>& camera_format_names() {
  static const std::vector<std::string> names{"ros", "opencv", "visp", "matlab"};
  return names;
}

CameraFormat camera_format(const std::string& name) {
  const auto& names = camera_format_names();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return static_cast<CameraFormat>(i);
  throw ConfigError(fmt::format("camera format '{}' is not known{}; choose one of {}", name, did_you_mean(name, names),
                                fmt::join(names, ", ")));
}

std::optional<CameraFormat> format_of_name(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension == ".m") return CameraFormat::MATLAB;
  if (extension == ".xml") return CameraFormat::VISP;
  if (extension == ".yaml" || extension == ".yml") return CameraFormat::ROS;
  return std::nullopt;
}

void set_matrix(CameraFile& file, const std::vector<double>& K, const std::string& where, const std::string& key) {
  if (K.size() != 9) throw InputError(fmt::format("{}: {}: must be 3 x 3, has {} numbers", where, key, K.size()));
  for (const double value : K)
    if (!std::isfinite(value)) throw InputError(fmt::format("{}: {}: holds {}; calibrate again", where, key, value));
  if (K[3] != 0 || K[6] != 0 || K[7] != 0 || std::abs(K[8] - 1) > 1e-9)
    throw InputError(fmt::format("{}: {}: must have the form [fx s cx; 0 fy cy; 0 0 1]", where, key));
  if (std::abs(K[1]) > 1e-9) {
    file.camera.skew = K[1];
    file.beyond =
        fmt::format("{}: {}: must have the form [fx 0 cx; 0 fy cy; 0 0 1], has a skew of {} px", where, key, K[1]);
  }
  Camera& camera = file.camera.camera;
  camera.fx = K[0];
  camera.cx = K[2];
  camera.fy = K[4];
  camera.cy = K[5];
}

void set_distortion(CameraFile& file, const std::vector<double>& k, const std::string& where, const std::string& key) {
  if (k.size() < 4)
    throw InputError(fmt::format("{}: {}: must hold k1, k2, p1, p2 [, k3], has {} numbers", where, key, k.size()));
  for (const double value : k)
    if (!std::isfinite(value)) throw InputError(fmt::format("{}: {}: holds {}; calibrate again", where, key, value));
  for (std::size_t i = 5; i < k.size(); ++i)
    if (k[i] != 0)
      throw InputError(
          fmt::format("{}: {}: the model has k1, k2, p1, p2 only, but number {} (a higher term) is {} and must be 0; "
                      "calibrate again with it fixed to 0",
                      where, key, i + 1, k[i]));
  if (k.size() > 4 && k[4] != 0) {
    file.camera.k5 = k[4];
    file.beyond = fmt::format(
        "{}: {}: the model has k1, k2, p1, p2 only, but number 5 (the third radial term) is {} and must be 0", where,
        key, k[4]);
  }
  Camera& camera = file.camera.camera;
  camera.k1 = k[0];
  camera.k2 = k[1];
  camera.k3 = k[2];
  camera.k4 = k[3];
}

CameraFile read_camera_file(const std::string& file) {
  const CameraFile result = read_any(read_text(file), file);
  check(result.camera, file);
  return result;
}

Camera read_camera(const std::string& file) {
  const CameraFile result = read_camera_file(file);
  if (!result.beyond.empty())
    throw InputError(result.beyond + "; 'heartservo camera convert --terms 4' makes the nearest file without it");
  return result.camera.camera;
}

void write_camera(const WideCamera& camera, CameraFormat format, const std::string& file, const std::string& name,
                  std::optional<double> kdu) {
  check(camera, file);
  if (format == CameraFormat::ROS) return write_whole_file(file, ros_text(camera, name));
  if (format == CameraFormat::VISP) {
    const Camera& c = camera.camera;
    return write_whole_file(file, visp_text(c, kdu ? *kdu : fit_backward(c, camera).kdu, name));
  }

  if (format == CameraFormat::MATLAB) return write_whole_file(file, matlab_text(camera));
  write_whole_file(file, opencv_text(camera, std::filesystem::path(file).extension() == ".xml"));
}

void write_ros_camera(const Camera& camera, const std::string& file, const std::string& name) {
  write_camera({camera}, CameraFormat::ROS, file, name);
}

void write_whole_file(const std::string& file, const std::string& text) {
  const std::string partial = file + ".partial";
  std::ofstream out(partial, std::ios::binary);
  out << text;
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(partial, file, error);
  if (!out || error) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw InputError(file + ": cannot be written; check that its folder exists and may be written to");
  }
}

}  // namespace heartservo::tracking
