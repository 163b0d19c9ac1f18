#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string_view>

#include "tracking/camera/camera_formats.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::tracking {

namespace {

struct Assignment {
  int line = 0;
  std::string value;  // without comments and line breaks
};

// Comments out, "..." and open brackets joined with the next line: one statement a string, with its first line.
std::vector<Assignment> statements_of(const std::string& text) {
  std::vector<Assignment> statements;
  std::istringstream in(text);
  std::string line;
  bool goes_on = false;
  int depth = 0;
  for (int number = 1; std::getline(in, line); ++number) {
    line = line.substr(0, line.find('%'));
    const auto dots = line.find("...");
    const bool continued = dots != std::string::npos;
    if (!goes_on) statements.push_back({number, ""});
    // inside brackets a new line is a new row
    statements.back().value += (goes_on && depth > 0 ? " ; " : " ") + line.substr(0, dots);
    for (const char c : line.substr(0, dots)) depth += c == '[' ? 1 : c == ']' ? -1 : 0;
    goes_on = continued || depth > 0;
  }
  return statements;
}

bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

// Cuts "name = value" from the front of `text`, value a bracket or all up to ';' or ','; false when there is none.
bool cut_assignment(std::string_view& text, std::string_view& name, std::string_view& value) {
  const auto skip = [&](const char* characters) {
    text.remove_prefix(std::min(text.find_first_not_of(characters), text.size()));
  };
  const auto cut = [&](std::size_t length) {
    const auto piece = text.substr(0, length);
    text.remove_prefix(piece.size());
    return piece;
  };
  skip(" \t\r;,'");
  name = cut(static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), is_letter) - text.begin()));
  skip(" \t\r");
  if (name.empty() || text.empty() || text[0] != '=') return false;
  cut(1);
  skip(" \t\r");
  value = !text.empty() && text[0] == '[' ? cut(text.find(']')) : cut(text.find_first_of(";,"));
  if (!text.empty() && text[0] == ']') text.remove_prefix(1);
  return true;
}

std::map<std::string, Assignment> assignments_of(const std::string& text) {
  std::map<std::string, Assignment> result;
  for (const auto& statement : statements_of(text)) {
    std::string_view rest = statement.value, name, value;
    while (cut_assignment(rest, name, value)) result[std::string(name)] = {statement.line, std::string(value)};
  }
  return result;
}

class MatlabFile {
 public:
  MatlabFile(const std::string& text, const std::string& file) : values_(assignments_of(text)), file_(file) {}

  bool has(const std::string& name) const { return values_.count(name) > 0; }

  std::string at(const std::string& name) const { return fmt::format("{}:{}", file_, values_.at(name).line); }

  std::vector<double> numbers(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) {
      std::vector<std::string> names;
      for (const auto& [key, value] : values_) names.push_back(key);
      throw InputError(fmt::format("{}: {}: is missing{}; save it again with the calibration toolbox", file_, name,
                                   did_you_mean(name, names)));
    }
    std::string list = found->second.value;
    for (char& c : list)
      if (c == '[' || c == ']' || c == ';' || c == ',') c = ' ';
    std::istringstream in(list);
    std::vector<double> result;
    for (std::string word; in >> word;) {
      char* end = nullptr;
      result.push_back(std::strtod(word.c_str(), &end));
      if (*end != '\0') throw InputError(fmt::format("{}: {}: '{}' is not a number", at(name), name, word));
    }
    return result;
  }

  std::vector<double> numbers(const std::string& name, std::size_t count) const {
    const auto result = numbers(name);
    if (result.size() != count)
      throw InputError(fmt::format("{}: {}: must hold {} numbers, has {}", at(name), name, count, result.size()));
    return result;
  }

  int size(const std::string& name) const {
    const double value = numbers(name, 1)[0];
    if (value != std::floor(value) || !(std::abs(value) < 1e6))
      throw InputError(fmt::format("{}: {}: must be a whole number of px, is {}", at(name), name, value));
    return static_cast<int>(value);
  }

 private:
  std::map<std::string, Assignment> values_;
  const std::string& file_;
};

}  // namespace

bool is_matlab_camera(const std::string& text) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    std::string_view rest = line, name, value;
    if (cut_assignment(rest, name, value) && (name == "fc" || name == "cc" || name == "kc" || name == "alpha_c"))
      return true;
  }
  return false;
}

CameraFile read_matlab_camera(const std::string& text, const std::string& file) {
  const MatlabFile matlab(text, file);
  const auto fc = matlab.numbers("fc", 2), cc = matlab.numbers("cc", 2);
  const double alpha_c = matlab.has("alpha_c") ? matlab.numbers("alpha_c", 1)[0] : 0;
  const auto kc = matlab.numbers("kc");
  CameraFile camera;
  camera.format = CameraFormat::MATLAB;
  camera.camera.camera.width = matlab.size("nx");
  camera.camera.camera.height = matlab.size("ny");
  const double skew = alpha_c * fc[0];
  for (const auto& [name, values] : {std::pair{"fc", fc}, {"cc", cc}, {"alpha_c", {alpha_c}}})
    for (const double value : values)
      if (!std::isfinite(value))
        throw InputError(fmt::format("{}: {}: holds {}; calibrate again", matlab.at(name), name, value));
  set_matrix(camera, {fc[0], skew, cc[0], 0, fc[1], cc[1], 0, 0, 1}, skew != 0 ? matlab.at("alpha_c") : file,
             "alpha_c");
  set_distortion(camera, kc, matlab.at("kc"), "kc");
  return camera;
}

std::string matlab_text(const WideCamera& wide) {
  const Camera& c = wide.camera;
  return fmt::format(
      "% Intrinsic camera parameters, as the camera calibration toolbox for Matlab writes them.\n"
      "% Pixel (0, 0) is the centre of the top-left pixel.\n"
      "fc = [ {} ; {} ];\ncc = [ {} ; {} ];\nalpha_c = {};\nkc = [ {} ; {} ; {} ; {} ; {} ];\nnx = {};\nny = {};\n",
      c.fx, c.fy, c.cx, c.cy, wide.skew / c.fx, c.k1, c.k2, c.k3, c.k4, wide.k5, c.width, c.height);
}

}  // namespace heartservo::tracking
