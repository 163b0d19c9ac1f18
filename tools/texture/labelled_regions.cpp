#include "tools/texture/labelled_regions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>

#include "tracking/frames/picture_file.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/texture/feature_bank.hpp"

namespace heartservo::tools {

namespace {

constexpr const char* kHeader = "file,x,y,width,height,class";

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r\""), last = text.find_last_not_of(" \t\r\"");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t comma = std::min(line.find(',', at), line.size());
    cells.push_back(trimmed(line.substr(at, comma - at)));
    at = comma + 1;
  }
  return cells;
}

int whole_number(const std::string& cell, const std::string& where) {
  int value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size())
    throw InputError(fmt::format("{}: '{}' is not a whole number of px", where, cell));
  return value;
}

}  // namespace

cv::Mat region_of(const cv::Mat& grey, const cv::Rect& r, const std::string& name) {
  const std::string what = fmt::format("region {},{},{},{}", r.x, r.y, r.width, r.height);
  if (r.width < kSmallestRegion_px || r.height < kSmallestRegion_px)
    throw ConfigError(fmt::format("{}: {} is too small; {} px a side or more", name, what, kSmallestRegion_px));
  if (r.x < 0 || r.y < 0 || r.x > grey.cols - r.width || r.y > grey.rows - r.height)
    throw ConfigError(fmt::format("{}: {} is not inside the picture of {} x {} px", name, what, grey.cols, grey.rows));
  return grey(r);
}

std::vector<LabelledRegion> read_labelled_regions(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  if (!in || std::filesystem::is_directory(csv)) throw InputError(csv.string() + ": cannot be read; check the path");
  std::string line;
  std::getline(in, line);
  if (line.rfind("\xEF\xBB\xBF", 0) == 0) line.erase(0, 3);
  if (cells_of(line) != cells_of(kHeader))
    throw InputError(fmt::format("{}:1: expected the header {}", csv.string(), kHeader));
  std::vector<LabelledRegion> regions;
  std::map<std::string, cv::Mat> pictures;
  for (int number = 2; std::getline(in, line); ++number) {
    if (trimmed(line).empty()) continue;
    const std::string where = fmt::format("{}:{}", csv.string(), number);
    const auto cells = cells_of(line);
    if (cells.size() != 6) throw InputError(fmt::format("{}: {} cells under 6 columns", where, cells.size()));
    if (cells[0].empty() || cells[5].empty()) throw InputError(where + ": file or class is empty");
    const auto [place, is_new] = pictures.try_emplace(cells[0]);
    if (is_new) {
      const tracking::Picture picture = tracking::read_picture((csv.parent_path() / cells[0]).string());
      if (!picture.problem.empty()) throw InputError(where + ": " + picture.problem);
      place->second = picture.grey;
    }
    const cv::Rect rect(whole_number(cells[1], where), whole_number(cells[2], where), whole_number(cells[3], where),
                        whole_number(cells[4], where));
    try {
      regions.push_back({region_of(place->second, rect, cells[0]), cells[5]});
    } catch (const ConfigError& e) {
      throw InputError(where + ": " + e.what());
    }
  }
  if (regions.empty()) throw InputError(csv.string() + ": has a header and no regions");
  return regions;
}

tracking::FeatureTable feature_table(const std::vector<LabelledRegion>& regions,
                                     const tracking::TextureSettings& settings) {
  tracking::FeatureTable table;
  for (const auto& feature : tracking::kFeatureNames) table.features.emplace_back(feature.name);
  table.values.resize(static_cast<Eigen::Index>(regions.size()), static_cast<Eigen::Index>(tracking::kFeatureCount));
  tracking::LevelImage levels;
  tracking::MatrixBuilder builder;
  tracking::TextureMatrices matrices;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const cv::Mat& grey = regions[i].grey;
    tracking::quantise(tracking::grey_region(grey, {0, 0, grey.cols, grey.rows}), settings, levels);
    builder.build(levels.region(), settings.distance, matrices);
    const tracking::FeatureBank bank = tracking::feature_bank(matrices);
    for (std::size_t k = 0; k < bank.size(); ++k)
      table.values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = bank[k];
    auto known = std::find(table.classes.begin(), table.classes.end(), regions[i].label);
    if (known == table.classes.end()) known = table.classes.insert(known, regions[i].label);
    table.label.push_back(static_cast<int>(known - table.classes.begin()));
  }
  return table;
}

}  // namespace heartservo::tools
