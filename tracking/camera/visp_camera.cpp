#include <fmt/format.h>
#include <fmt/ranges.h>
#include <visp3/core/vpXmlParserCamera.h>

#include <regex>

#include "tracking/camera/camera_formats.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/quiet_streams.hpp"

namespace heartservo::tracking {

namespace {

// The parser wants the camera's exact name before it reads anything.
std::vector<std::string> camera_names(std::string text) {
  for (auto from = text.find("<!--"); from != std::string::npos; from = text.find("<!--", from)) {
    const auto to = text.find("-->", from);
    text.erase(from, to == std::string::npos ? to : to + 3 - from);
  }
  std::vector<std::string> names;
  static const std::regex name("<name>([^<]*)</name>");
  for (auto from = text.find("<camera>"); from != std::string::npos;) {
    const auto to = text.find("<camera>", from + 1);
    const std::string block = text.substr(from, to == std::string::npos ? to : to - from);
    std::smatch found;
    names.push_back(std::regex_search(block, found, name) ? found[1].str() : "");
    from = to;
  }
  return names;
}

}  // namespace

CameraFile read_visp_camera(const std::string& text, const std::string& file) {
  const auto names = camera_names(text);
  if (names.empty()) throw InputError(file + ": holds no <camera>; expected ViSP's or OpenCV's XML");
  if (names.size() > 1)
    throw InputError(
        fmt::format("{}: holds {} cameras ({}); keep the one to use", file, names.size(), fmt::join(names, ", ")));
  for (const auto model :
       {vpCameraParameters::perspectiveProjWithDistortion, vpCameraParameters::perspectiveProjWithoutDistortion}) {
    vpXmlParserCamera parser;
    vpCameraParameters parameters;
    bool found = false;
    {
      const QuietStreams quiet;
      found = parser.parse(parameters, file, names.front(), model) == vpXmlParserCamera::SEQUENCE_OK;
    }
    if (!found) continue;
    if (parser.getWidth() == 0 || parser.getHeight() == 0)
      throw InputError(fmt::format("{}: {}: is missing or 0; add the size of the picture in px", file,
                                   parser.getWidth() == 0 ? "image_width" : "image_height"));
    CameraFile camera;
    camera.format = CameraFormat::VISP;
    camera.camera.camera.width = static_cast<int>(parser.getWidth());
    camera.camera.camera.height = static_cast<int>(parser.getHeight());
    set_matrix(camera,
               {parameters.get_px(), 0, parameters.get_u0(), 0, parameters.get_py(), parameters.get_v0(), 0, 0, 1},
               file, "px, py, u0, v0");
    // ViSP: u = u0 + px x (1 + kud r^2), exactly eq. 3 with k1 alone
    if (model == vpCameraParameters::perspectiveProjWithDistortion)
      set_distortion(camera, {parameters.get_kud(), 0, 0, 0}, file, "kud");
    return camera;
  }
  if (text.find("KannalaBrandt") != std::string::npos)
    throw InputError(file +
                     ": model.type: Kannala-Brandt (fish-eye) is not supported; calibrate as "
                     "perspectiveProjWithDistortion");
  throw InputError(file +
                   ": model: no complete perspectiveProjWithDistortion (px, py, u0, v0, kud, kdu) or "
                   "perspectiveProjWithoutDistortion; save it again with vpXmlParserCamera");
}

std::string visp_text(const Camera& camera, double kdu, const std::string& name) {
  std::string plain;  // what needs no escaping in XML
  for (const char c : name) plain += c == '<' || c == '>' || c == '&' || c == '"' ? '_' : c;
  const auto model = [&](const char* type, const std::string& distortion) {
    return fmt::format(
        "    <model>\n      <type>{}</type>\n      <px>{}</px>\n      <py>{}</py>\n      <u0>{}</u0>\n      "
        "<v0>{}</v0>\n{}    </model>\n",
        type, camera.fx, camera.fy, camera.cx, camera.cy, distortion);
  };
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<root>\n  <camera>\n    <name>{}</name>\n    <image_width>{}</image_width>\n    "
      "<image_height>{}</image_height>\n{}  </camera>\n</root>\n",
      plain, camera.width, camera.height,
      camera.has_distortion() ? model("perspectiveProjWithDistortion",
                                      fmt::format("      <kud>{}</kud>\n      <kdu>{}</kdu>\n", camera.k1, kdu))
                              : model("perspectiveProjWithoutDistortion", ""));
}

}  // namespace heartservo::tracking
