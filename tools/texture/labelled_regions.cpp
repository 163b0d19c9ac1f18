#include "tools/texture/labelled_regions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tracking/frames/picture_file.hpp"
#include "tracking/settings/csv_rows.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/texture/feature_bank.hpp"

namespace heartservo::tools {

namespace {

const std::vector<std::string>& header() {
  static const std::vector<std::string> names{"file", "x", "y", "width", "height", "class"};
  return names;
}

int whole_number(const CsvRows& rows, std::size_t column) {
  const double value = rows.number(column);
  if (value != std::floor(value) || std::abs(value) > 1e6)
    rows.fail(fmt::format("'{}' is not a whole number of px", rows.cells()[column]));
  return static_cast<int>(value);
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
  const std::string expected = fmt::format("the header {}", fmt::join(header(), ","));
  CsvRows rows(csv, expected);
  if (rows.names() != header()) rows.fail("expected " + expected);
  std::vector<LabelledRegion> regions;
  std::map<std::string, cv::Mat> pictures;
  while (rows.next()) {
    const std::string file(rows.cells()[0]), label(rows.cells()[5]);
    if (file.empty() || label.empty()) rows.fail("file or class is empty");
    const auto [place, is_new] = pictures.try_emplace(file);
    if (is_new) {
      const tracking::Picture picture = tracking::read_picture((csv.parent_path() / file).string());
      if (!picture.problem.empty()) rows.fail(picture.problem);
      place->second = picture.grey;
    }
    const cv::Rect rect(whole_number(rows, 1), whole_number(rows, 2), whole_number(rows, 3), whole_number(rows, 4));
    try {
      regions.push_back({region_of(place->second, rect, file), label});
    } catch (const ConfigError& e) {
      rows.fail(e.what());
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
