#include "tracking/camera/stereo_camera.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/SVD>
#include <cmath>
#include <fstream>
#include <opencv2/core.hpp>

#include "tracking/camera/camera_file.hpp"
#include "tracking/camera/camera_formats.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

constexpr double SHORTEST_BASELINE_M = 1e-4, LONGEST_BASELINE_M = 0.5;

class StereoFile {
 public:
  explicit StereoFile(const std::string& file) : file_(file) {
    try {
      storage_.open(file, cv::FileStorage::READ);
    } catch (const cv::Exception& e) {
      throw InputError(fmt::format("{}: not a readable OpenCV FileStorage: {}; write it again", file, e.err));
    }
    if (!storage_.isOpened()) throw InputError(file + ": cannot be read as OpenCV FileStorage; check the path");
  }

  std::vector<double> matrix(const char* key) const {
    const cv::FileNode node = storage_[key];
    if (node.empty()) throw InputError(fmt::format("{}: {}: key is missing; add it", file_, key));
    cv::Mat m;
    if (node.isMap()) node >> m;
    if (m.empty() || m.channels() != 1)
      throw InputError(fmt::format("{}: {}: must be a matrix of numbers", file_, key));
    m.convertTo(m, CV_64F);
    return {m.begin<double>(), m.end<double>()};
  }

  std::vector<double> matrix(const char* key, std::size_t size) const {
    const auto numbers = matrix(key);
    if (numbers.size() != size)
      throw InputError(fmt::format("{}: {}: must hold {} numbers, has {}", file_, key, size, numbers.size()));
    for (const double value : numbers)
      if (!std::isfinite(value)) throw InputError(fmt::format("{}: {}: holds {}; calibrate again", file_, key, value));
    return numbers;
  }

  Camera camera(const char* matrix_key, const char* distortion_key) const {
    CameraFile camera;
    camera.camera.camera.width = size("image_width");
    camera.camera.camera.height = size("image_height");
    set_matrix(camera, matrix(matrix_key), file_, matrix_key);
    set_distortion(camera, matrix(distortion_key), file_, distortion_key);
    if (!camera.beyond.empty()) throw InputError(camera.beyond + "; calibrate again");
    return camera.camera.camera;
  }

  // Metres in one unit of T.
  double length_unit() const {
    const cv::FileNode node = storage_["length_unit"];
    if (node.empty()) return 1;
    const std::string unit = node.isString() ? node.string() : "";
    if (unit != "m" && unit != "mm") throw InputError(file_ + ": length_unit: must be m or mm");
    return unit == "m" ? 1 : 1e-3;
  }

 private:
  int size(const char* key) const {
    const cv::FileNode node = storage_[key];
    if (!node.isInt()) throw InputError(fmt::format("{}: {}: must be a whole number of px; add it", file_, key));
    return static_cast<int>(node);
  }

  const std::string& file_;
  cv::FileStorage storage_;
};

Eigen::Matrix3d rotation_of(const std::vector<double>& numbers, const std::string& file) {
  const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
  if ((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() > 1e-3 || R.determinant() < 0)
    throw InputError(file + ": R: is not a rotation matrix; calibrate again");
  return Eigen::Quaterniond(R).normalized().toRotationMatrix();
}

void check(const StereoCamera& stereo, const std::string& file) {
  const auto problems = stereo.validate();
  if (!problems.empty())
    throw InputError(
        fmt::format("{}: not a usable stereo camera: {}; calibrate again", file, fmt::join(problems, "; ")));
}

cv::Mat matrix_of(const Camera& c) { return (cv::Mat_<double>(3, 3) << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1); }
cv::Mat distortion_of(const Camera& c) { return (cv::Mat_<double>(1, 5) << c.k1, c.k2, c.k3, c.k4, 0); }

}  // namespace

std::vector<std::string> StereoCamera::validate() const {
  std::vector<std::string> problems;
  for (const auto& [side, camera] : {std::pair{"left", &left}, {"right", &right}})
    for (const auto& problem : camera->validate()) problems.push_back(fmt::format("{}: {}", side, problem));
  if (left.width != right.width || left.height != right.height)
    problems.push_back(fmt::format("the pictures have other sizes, {} x {} and {} x {} px", left.width, left.height,
                                   right.width, right.height));
  const double baseline = baseline_m();
  if (!(baseline >= SHORTEST_BASELINE_M && baseline <= LONGEST_BASELINE_M))
    problems.push_back(
        fmt::format("T: the cameras are {:.4g} m apart, must be {} to {} m (is T in mm? say so by "
                    "length_unit: \"mm\")",
                    baseline, SHORTEST_BASELINE_M, LONGEST_BASELINE_M));
  return problems;
}

StereoCamera read_stereo_camera(const std::string& file) {
  read_camera(file);  // says what is wrong with the file as such, and with the left camera
  try {
    const StereoFile storage(file);
    StereoCamera stereo;
    stereo.left = storage.camera("M1", "D1");
    stereo.right = storage.camera("M2", "D2");
    stereo.T_right_left.linear() = rotation_of(storage.matrix("R", 9), file);
    const auto T = storage.matrix("T", 3);
    stereo.T_right_left.translation() = storage.length_unit() * Eigen::Vector3d(T[0], T[1], T[2]);
    check(stereo, file);
    return stereo;
  } catch (const cv::Exception& e) {
    throw InputError(fmt::format("{}: not a readable stereo camera: {}; write it again", file, e.err));
  }
}

void write_stereo_camera(const StereoCamera& stereo, const std::string& file) {
  check(stereo, file);
  const Eigen::Matrix3d& R = stereo.T_right_left.linear();
  const Eigen::Vector3d& T = stereo.T_right_left.translation();
  cv::FileStorage out(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  out << "image_width" << stereo.left.width << "image_height" << stereo.left.height << "M1" << matrix_of(stereo.left)
      << "D1" << distortion_of(stereo.left) << "M2" << matrix_of(stereo.right) << "D2" << distortion_of(stereo.right)
      << "R"
      << (cv::Mat_<double>(3, 3) << R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2))
      << "T" << (cv::Mat_<double>(3, 1) << T.x(), T.y(), T.z()) << "length_unit"
      << "m";
  write_whole_file(file, out.releaseAndGetString());
}

bool is_stereo_file(const std::string& file) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (line.rfind("M2:", 0) == 0 || line.find("<M2 ") != std::string::npos) return true;
  return false;
}

}  // namespace heartservo::tracking
