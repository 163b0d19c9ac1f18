#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "tracking/camera/camera_formats.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::tracking {

namespace {

class RosFile {
 public:
  RosFile(const YAML::Node& root, const std::string& file) : root_(root), file_(file) {}

  std::string at(const YAML::Node& node) const {
    return node.Mark().line >= 0 ? fmt::format("{}:{}", file_, node.Mark().line + 1) : file_;
  }

  YAML::Node key(const std::string& name) const {
    const YAML::Node node = root_[name];
    if (node.IsDefined() && !node.IsNull()) return node;
    std::vector<std::string> present;
    for (const auto& entry : root_)
      if (entry.first.IsScalar()) present.push_back(entry.first.Scalar());
    throw InputError(fmt::format("{}: {}: key is missing{}; expected a ROS, OpenCV, ViSP or Matlab camera file", file_,
                                 name, did_you_mean(name, present)));
  }

  int size(const std::string& name) const {
    const YAML::Node node = key(name);
    int value = 0;
    if (!node.IsScalar() || !YAML::convert<int>::decode(node, value))
      throw InputError(fmt::format("{}: {}: must be a whole number of px", at(node), name));
    return value;
  }

  // The `data` of a matrix, whose rows and cols, where given, must fit it.
  std::vector<double> matrix(const std::string& name) const {
    const YAML::Node node = key(name);
    const YAML::Node list = node.IsMap() ? node["data"] : YAML::Node(YAML::NodeType::Undefined);
    if (!list.IsDefined() || !list.IsSequence())
      throw InputError(fmt::format("{}: {}.data: must be a list of numbers", at(node), name));
    std::vector<double> numbers;
    for (const auto& item : list) {
      double value = 0;
      if (!item.IsScalar() || !YAML::convert<double>::decode(item, value))
        throw InputError(fmt::format("{}: {}.data: must hold numbers only", at(item), name));
      numbers.push_back(value);
    }
    int rows = 0, cols = 0;
    const YAML::Node rows_node = node["rows"], cols_node = node["cols"];
    if (rows_node.IsDefined() && cols_node.IsDefined() &&
        (!YAML::convert<int>::decode(rows_node, rows) || !YAML::convert<int>::decode(cols_node, cols) ||
         static_cast<long long>(rows) * cols != static_cast<long long>(numbers.size())))
      throw InputError(
          fmt::format("{}: {}.data: has {} numbers, rows and cols say otherwise", at(list), name, numbers.size()));
    return numbers;
  }

 private:
  const YAML::Node root_;
  const std::string& file_;
};

}  // namespace

CameraFile read_ros_camera(const YAML::Node& root, const std::string& file) {
  const RosFile ros(root, file);
  CameraFile camera;
  camera.camera.camera.width = ros.size("image_width");
  camera.camera.camera.height = ros.size("image_height");
  set_matrix(camera, ros.matrix("camera_matrix"), ros.at(root["camera_matrix"]), "camera_matrix.data");
  const YAML::Node model = ros.key("distortion_model");
  if (!model.IsScalar() || model.Scalar() != "plumb_bob")
    throw InputError(fmt::format("{}: distortion_model: must be plumb_bob (k1, k2, p1, p2), is '{}'; calibrate with it",
                                 ros.at(model), model.IsScalar() ? model.Scalar() : "no text"));
  const std::string key = "distortion_coefficients";
  const std::vector<double> k = ros.matrix(key);
  if (k.size() > 5)
    throw InputError(
        fmt::format("{}: {}.data: plumb_bob has 4 or 5 numbers, not {}", ros.at(root[key]), key, k.size()));
  set_distortion(camera, k, ros.at(root[key]), key + ".data");
  return camera;
}

std::string ros_text(const WideCamera& wide, const std::string& name) {
  const Camera& camera = wide.camera;
  YAML::Emitter quoted_name;
  quoted_name << YAML::DoubleQuoted << name;
  return fmt::format(
      "image_width: {}\nimage_height: {}\ncamera_name: {}\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [{fx}, 0, {cx}, 0, {fy}, {cy}, 0, 0, 1]\n"
      "distortion_model: plumb_bob\n"
      "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [{}, {}, {}, {}, {}]\n"
      "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
      "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [{fx}, 0, {cx}, 0, 0, {fy}, {cy}, 0, 0, 0, 1, 0]\n",
      camera.width, camera.height, quoted_name.c_str(), camera.k1, camera.k2, camera.k3, camera.k4, wide.k5,
      fmt::arg("fx", camera.fx), fmt::arg("fy", camera.fy), fmt::arg("cx", camera.cx), fmt::arg("cy", camera.cy));
}

}  // namespace heartservo::tracking
