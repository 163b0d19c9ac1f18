#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "sim/table/table.hpp"
#include "tools/command.hpp"
#include "tools/texture/texture_tasks.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/frames/open_source.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/texture/feature_bank.hpp"
#include "tracking/texture/texture_vector.hpp"

namespace heartservo::tools {

namespace {

cv::Mat read_frame(tracking::FrameSource& frames, const std::string& source, int index) {
  tracking::Frame frame;
  for (int k = 0; k <= index; ++k)
    if (!frames.next(frame))
      throw ConfigError(fmt::format("{}: there is no frame {}; it has {}, counted from 0", source, index, k));
  if (frame.status != tracking::FrameStatus::OK) throw InputError(source + ": " + frame.note);
  return frame.grey.clone();
}

}  // namespace

cv::Rect parse_region(const std::string& text) {
  std::istringstream in(text);
  int number[4] = {};
  for (int k = 0; k < 4; ++k) {
    if (k > 0 && in.get() != ',') in.setstate(std::ios::failbit);
    in >> number[k];
  }
  if (!in || in.peek() != std::istringstream::traits_type::eof())
    throw ConfigError(fmt::format("--roi '{}': expected x,y,width,height in whole px", text));
  return {number[0], number[1], number[2], number[3]};
}

cv::Mat frame_of(const std::string& source, int index) {
  if (source.empty()) throw ConfigError("SOURCE is missing: give frames or a scene such as scenes/pig_2007.yaml");
  if (!is_scene(source)) return read_frame(*tracking::open_source(source, 0), source, index);
  sim::Scene scene = sim::load_scene(source);
  scene.show_tool = false;
  return read_frame(sim::make_table(scene)->frames(), source, index);
}

nlohmann::json describe_texture(const DescribeOptions& o) {
  if (o.regions.empty()) throw ConfigError("--roi is missing: give a region as x,y,width,height in px");
  std::vector<cv::Rect> rects;
  for (const auto& text : o.regions) rects.push_back(parse_region(text));
  const cv::Mat grey = frame_of(o.source, o.frame);
  nlohmann::json result{
      {"command", "texture describe"}, {"version", HEARTSERVO_VERSION},  {"source", o.source},      {"frame", o.frame},
      {"levels", o.texture.levels},    {"distance", o.texture.distance}, {"range", o.texture.range}};
  tracking::TextureDescriber describer(o.texture);
  std::vector<tracking::TextureVector> vectors;
  for (const auto& rect : rects) {
    region_of(grey, rect, o.source);  // or says why not
    vectors.push_back(describer.describe(tracking::grey_region(grey, rect)));
    const auto bank = tracking::feature_bank(describer.matrices());
    nlohmann::json vector, features;
    for (std::size_t k = 0; k < 8; ++k) vector[std::string(tracking::kTextureNames[k])] = vectors.back()[k];
    const auto paper = tracking::paper_features();
    for (std::size_t k = 0; k < bank.size(); ++k)
      if (o.full || std::find(paper.begin(), paper.end(), k) != paper.end())
        features[std::string(tracking::kFeatureNames[k].name)] = bank[k];
    result["regions"].push_back(
        {{"roi", {rect.x, rect.y, rect.width, rect.height}}, {"vector", vector}, {"features", features}});
  }
  for (const auto& a : vectors) {
    nlohmann::json row;
    for (const auto& b : vectors) row.push_back(tracking::texture_distance(a, b));
    result["distances"].push_back(row);
  }
  return result;
}

std::string describe_text(const nlohmann::json& d) {
  std::string text = fmt::format("{}, frame {}: {} levels, distance {} px\n{:<20}", d["source"].get<std::string>(),
                                 d["frame"].get<int>(), d["levels"].get<int>(), d["distance"].get<int>(), "in [0, 1]");
  const auto& regions = d["regions"];
  for (const auto& region : regions) {
    const auto roi = region["roi"].get<std::vector<int>>();
    text += fmt::format(" {:>16}", fmt::format("{},{},{},{}", roi[0], roi[1], roi[2], roi[3]));
  }
  const auto add_row = [&](const std::string& group, std::string_view name, const char* format) {
    text += fmt::format("\n{:<20}", name);
    for (const auto& region : regions)
      text += fmt::format(fmt::runtime(format), region[group][std::string(name)].get<double>());
  };
  for (const auto name : tracking::kTextureNames) add_row("vector", name, " {:>16.4f}");
  text += "\n\nas defined";
  for (const auto& feature : tracking::kFeatureNames)
    if (regions[0]["features"].contains(std::string(feature.name))) add_row("features", feature.name, " {:>16.6g}");
  if (regions.size() > 1) {
    text += "\n\ndistance (eq. 10)";
    for (const auto& row : d["distances"]) {
      text += fmt::format("\n{:<20}", "");
      for (const auto& value : row) text += fmt::format(" {:>16.4f}", value.get<double>());
    }
  }
  return text + "\n";
}

}  // namespace heartservo::tools
