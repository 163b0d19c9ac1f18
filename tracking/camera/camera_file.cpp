#include "tracking/camera/camera_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tracking/camera/camera_formats.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

constexpr std::uintmax_t LARGEST_FILE = 4'000'000;  // bytes; a calibration with all its board views is far smaller

std::string read_text(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(file + ": no such file; check the path");
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError(file + ": is not a file; name a calibration file");
  if (std::filesystem::file_size(file, error) > LARGEST_FILE)
    throw InputError(file + ": is too large for a calibration; expected a ROS, OpenCV or ViSP camera file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file + ": cannot be read; check its permissions");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    throw InputError(file + ": is empty; expected a ROS, OpenCV or ViSP camera file");
  if (text.find('\0') != std::string::npos)
    throw InputError(file + ": is not a text file; expected a ROS, OpenCV or ViSP camera file");
  return text;
}

// OpenCV's dialect of YAML (its header, its matrix tag, ORB-SLAM's dotted keys) is not always YAML.
bool is_opencv_yaml(const std::string& text) {
  for (const char* sign : {"%YAML:", "!!opencv-matrix", "\nCamera.fx", "\nCamera1.fx", "\nLEFT.K"})
    if (("\n" + text).find(sign) != std::string::npos) return true;
  return false;
}

Camera read_any(const std::string& text, const std::string& file) {
  if (text[text.find_first_not_of(" \t\r\n\xEF\xBB\xBF")] == '<')
    return text.find("<opencv_storage") != std::string::npos ? read_opencv_camera(text, file)
                                                             : read_visp_camera(text, file);
  if (is_opencv_yaml(text)) return read_opencv_camera(text, file);
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& e) {
    throw InputError(fmt::format("{}:{}: is no camera file that can be read: {}", file, e.mark.line + 1, e.msg));
  }
  if (!root.IsMap()) throw InputError(file + ": holds no keys; expected a ROS, OpenCV or ViSP camera file");
  return read_ros_camera(root, file);
}

void check(const Camera& camera, const std::string& file) {
  const auto problems = camera.validate();
  if (!problems.empty())
    throw InputError(fmt::format("{}: not a usable camera: {}; calibrate again", file, fmt::join(problems, "; ")));
}

}  // namespace

void set_matrix(Camera& camera, const std::vector<double>& K, const std::string& where, const std::string& key) {
  if (K.size() != 9) throw InputError(fmt::format("{}: {}: must be 3 x 3, has {} numbers", where, key, K.size()));
  for (const double value : K)
    if (!std::isfinite(value)) throw InputError(fmt::format("{}: {}: holds {}; calibrate again", where, key, value));
  if (std::abs(K[1]) > 1e-9 || K[3] != 0 || K[6] != 0 || K[7] != 0 || std::abs(K[8] - 1) > 1e-9)
    throw InputError(
        fmt::format("{}: {}: must have the form [fx 0 cx; 0 fy cy; 0 0 1]; calibrate without skew", where, key));
  camera.fx = K[0];
  camera.cx = K[2];
  camera.fy = K[4];
  camera.cy = K[5];
}

void set_distortion(Camera& camera, const std::vector<double>& k, const std::string& where, const std::string& key) {
  if (k.size() < 4)
    throw InputError(fmt::format("{}: {}: must hold k1, k2, p1, p2 [, k3], has {} numbers", where, key, k.size()));
  for (const double value : k)
    if (!std::isfinite(value)) throw InputError(fmt::format("{}: {}: holds {}; calibrate again", where, key, value));
  for (std::size_t i = 4; i < k.size(); ++i)
    if (k[i] != 0)
      throw InputError(
          fmt::format("{}: {}: the model has k1, k2, p1, p2 only, but number {} ({}) is {} and must be 0; calibrate "
                      "again with it fixed to 0",
                      where, key, i + 1, i == 4 ? "the third radial term" : "a higher term", k[i]));
  camera.k1 = k[0];
  camera.k2 = k[1];
  camera.k3 = k[2];
  camera.k4 = k[3];
}

Camera read_camera(const std::string& file) {
  const Camera camera = read_any(read_text(file), file);
  check(camera, file);
  return camera;
}

void write_ros_camera(const Camera& camera, const std::string& file, const std::string& name) {
  check(camera, file);
  YAML::Emitter quoted_name;
  quoted_name << YAML::DoubleQuoted << name;
  const std::string text = fmt::format(
      "image_width: {}\nimage_height: {}\ncamera_name: {}\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [{fx}, 0, {cx}, 0, {fy}, {cy}, 0, 0, 1]\n"
      "distortion_model: plumb_bob\n"
      "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [{}, {}, {}, {}, 0]\n"
      "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
      "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [{fx}, 0, {cx}, 0, 0, {fy}, {cy}, 0, 0, 0, 1, 0]\n",
      camera.width, camera.height, quoted_name.c_str(), camera.k1, camera.k2, camera.k3, camera.k4,
      fmt::arg("fx", camera.fx), fmt::arg("fy", camera.fy), fmt::arg("cx", camera.cx), fmt::arg("cy", camera.cy));
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
