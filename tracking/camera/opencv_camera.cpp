#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "tracking/camera/camera_formats.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

using Names = std::vector<std::string>;

const Names MATRICES{"camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "LEFT.K", "M1"};

// The first of the names that the file has.
std::pair<cv::FileNode, std::string> first_of(const cv::FileStorage& storage, const Names& names) {
  for (const auto& name : names) {
    const cv::FileNode node = storage[name];
    if (!node.empty() && !node.isNone()) return {node, name};
  }
  return {cv::FileNode(), ""};
}

[[noreturn]] void fail_missing(const std::string& file, const Names& names) {
  throw InputError(fmt::format("{}: {}: key is missing (nor is there any of its other names: {}); add it", file,
                               names.front(), fmt::join(names.begin() + 1, names.end(), ", ")));
}

double number(const cv::FileNode& node, const std::string& file, const std::string& key) {
  if (!node.isInt() && !node.isReal()) throw InputError(fmt::format("{}: {}: must be a number", file, key));
  return node.real();
}

// A matrix or a plain list, row by row.
std::vector<double> numbers(const cv::FileNode& node, const std::string& file, const std::string& key) {
  std::vector<double> result;
  if (node.isSeq()) {
    for (const auto& item : node) result.push_back(number(item, file, key));
    return result;
  }
  cv::Mat matrix;
  if (node.isMap()) node >> matrix;
  if (matrix.empty() || matrix.channels() != 1)
    throw InputError(fmt::format("{}: {}: must be a matrix of numbers", file, key));
  matrix.convertTo(matrix, CV_64F);
  result.assign(matrix.begin<double>(), matrix.end<double>());
  return result;
}

int whole_number(const cv::FileNode& node, const std::string& file, const std::string& key) {
  const double value = number(node, file, key);
  if (value != std::floor(value) || std::abs(value) > 1e6)
    throw InputError(fmt::format("{}: {}: must be a whole number of px, is {}", file, key, value));
  return static_cast<int>(value);
}

void read_size(Camera& camera, const cv::FileStorage& storage, const std::string& file) {
  const Names widths{"image_width", "image_Width",  "imageWidth",   "width",
                     "LEFT.width",  "Camera.width", "Camera1.width"};
  const Names heights{"image_height", "image_Height",  "imageHeight",   "height",
                      "LEFT.height",  "Camera.height", "Camera1.height"};
  const auto [pair, pair_name] = first_of(storage, {"image_size", "imageSize"});
  if (!pair_name.empty()) {
    const auto size = numbers(pair, file, pair_name);
    if (size.size() != 2) throw InputError(fmt::format("{}: {}: must be width and height", file, pair_name));
    camera.width = whole_number(pair[0], file, pair_name);
    camera.height = whole_number(pair[1], file, pair_name);
    return;
  }
  const auto [width, width_name] = first_of(storage, widths);
  const auto [height, height_name] = first_of(storage, heights);
  if (width_name.empty()) fail_missing(file, widths);
  if (height_name.empty()) fail_missing(file, heights);
  camera.width = whole_number(width, file, width_name);
  camera.height = whole_number(height, file, height_name);
}

// ORB-SLAM: one key per number; `prefix` is "Camera." or "Camera1.". Absent distortion is none.
void read_scalars(CameraFile& camera, const cv::FileStorage& storage, const std::string& file,
                  const std::string& prefix) {
  const auto get = [&](const char* name, bool needed) {
    const std::string key = prefix + name;
    const cv::FileNode node = storage[key];
    if (node.empty() && needed) throw InputError(fmt::format("{}: {}: key is missing; add it", file, key));
    return node.empty() ? 0.0 : number(node, file, key);
  };
  const cv::FileNode type = storage["Camera.type"];
  if (type.isString() && type.string() != "PinHole" && type.string() != "Pinhole" && type.string() != "Rectified")
    throw InputError(fmt::format("{}: Camera.type: must be PinHole, is {}; calibrate with it", file, type.string()));
  set_matrix(camera, {get("fx", true), 0, get("cx", true), 0, get("fy", true), get("cy", true), 0, 0, 1}, file,
             prefix + "fx .. cy");
  set_distortion(camera, {get("k1", false), get("k2", false), get("p1", false), get("p2", false), get("k3", false)},
                 file, prefix + "k1 .. k3");
}

void read_matrices(CameraFile& camera, const cv::FileStorage& storage, const std::string& file) {
  const Names distortions{
      "distortion_coefficients", "distCoeffs", "Distortion_Coefficients", "dist_coeffs", "D", "LEFT.D", "D1"};
  const auto [matrix, matrix_name] = first_of(storage, MATRICES);
  const auto [distortion, distortion_name] = first_of(storage, distortions);
  if (matrix_name.empty()) fail_missing(file, MATRICES);
  if (distortion_name.empty()) fail_missing(file, distortions);
  if (const cv::FileNode fisheye = storage["fisheye_model"]; !fisheye.empty() && number(fisheye, file, "fisheye_model"))
    throw InputError(file + ": fisheye_model: fish-eye cameras are not supported; calibrate without it");
  set_matrix(camera, numbers(matrix, file, matrix_name), file, matrix_name);
  set_distortion(camera, numbers(distortion, file, distortion_name), file, distortion_name);
}

}  // namespace

CameraFile read_opencv_camera(const std::string& text, const std::string& file) {
  const bool needs_header = text.find("<opencv_storage") == std::string::npos && text.rfind("%YAML", 0) != 0;
  try {
    const cv::FileStorage storage(needs_header ? "%YAML:1.0\n---\n" + text : text,
                                  cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (!storage.isOpened()) throw InputError(file + ": cannot be read as OpenCV FileStorage; check the file");
    CameraFile camera;
    camera.format = CameraFormat::OPENCV;
    // An ORB-SLAM stereo file has both: LEFT.K for the picture as taken, which is what trackers see here, and Camera.fx
    // for the rectified one.
    const bool scalars = first_of(storage, MATRICES).second.empty();
    if (scalars && !storage["Camera.fx"].empty())
      read_scalars(camera, storage, file, "Camera.");
    else if (scalars && !storage["Camera1.fx"].empty())
      read_scalars(camera, storage, file, "Camera1.");
    else
      read_matrices(camera, storage, file);
    read_size(camera.camera.camera, storage, file);
    return camera;
  } catch (const cv::Exception& e) {
    throw InputError(fmt::format("{}: not a readable OpenCV FileStorage: {}; write it again", file, e.err));
  }
}

std::string opencv_text(const WideCamera& wide, bool xml) {
  const Camera& c = wide.camera;
  const cv::Mat K = (cv::Mat_<double>(3, 3) << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  const cv::Mat D = (cv::Mat_<double>(1, 5) << c.k1, c.k2, c.k3, c.k4, wide.k5);
  cv::FileStorage out(xml ? ".xml" : ".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  out << "image_width" << c.width << "image_height" << c.height << "camera_matrix" << K << "distortion_coefficients"
      << D;
  return out.releaseAndGetString();
}

}  // namespace heartservo::tracking
