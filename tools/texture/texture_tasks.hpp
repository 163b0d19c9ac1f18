#pragma once
// What `heartservo texture` does: results as JSON, and the text that people read of them.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "tools/report/report.hpp"
#include "tools/texture/labelled_regions.hpp"
#include "tracking/texture/levels.hpp"

namespace heartservo::tools {

struct DescribeOptions {
  std::string source;
  std::vector<std::string> regions;  ///< "x,y,width,height" in px
  int frame = 0;                     ///< of the source, from 0
  tracking::TextureSettings texture;
  bool full = false;  ///< the whole bank, and not the paper's eight alone
};

/// "x,y,width,height" as a rectangle. Throws ConfigError.
cv::Rect parse_region(const std::string& text);

/// Frame number `index` of a scene or of recorded frames, grey. Throws ConfigError (no such frame), InputError.
cv::Mat frame_of(const std::string& source, int index);

/// {"command", "source", "frame", "levels", "distance", "range", "regions": [{"roi", "vector": {name: 0..1},
///  "features": {name: value}}], "distances": [[t of eq. 10]]}
nlohmann::json describe_texture(const DescribeOptions& options);
std::string describe_text(const nlohmann::json& description);

struct SelectOptions {
  std::string csv;
  bool simulated = false;
  int seed = 1, per_class = 60;  ///< of the simulated regions
  int count = 8;                 ///< features to choose
  double max_correlation = 0.95;
  tracking::TextureSettings texture;
};

/// The regions that the options name. Throws ConfigError (neither or both sources), InputError.
std::vector<LabelledRegion> regions_for(const SelectOptions& options);

/// {"command", "source", "samples", "classes": [{"name", "samples"}], "features": [{"rank", "name", "group", "F_alone",
///  "F_to_enter", "wilks_lambda", "communality", "redundant_with"}], "constant": [...], "explained": [...],
///  "components_kept", "discriminant": [{"power", "share", "canonical_correlation"}],
///  "chosen": {"features", "wilks_lambda", "accuracy"}, "paper": {same}, "overlap": [...]}
/// Throws InputError when the regions cannot be used.
nlohmann::json select_texture(const SelectOptions& options, const std::vector<LabelledRegion>& regions);
std::string select_text(const nlohmann::json& selection);
Report select_report(const nlohmann::json& selection, const std::vector<LabelledRegion>& regions);

}  // namespace heartservo::tools
