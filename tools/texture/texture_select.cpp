#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tools/texture/texture_tasks.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/texture/feature_bank.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;

std::vector<std::string> names_of(const std::vector<std::size_t>& features) {
  std::vector<std::string> names;
  for (const std::size_t k : features) names.emplace_back(tracking::kFeatureNames[k].name);
  return names;
}

json set_json(const tracking::FeatureTable& table, const std::vector<std::size_t>& features,
              const tracking::SelectionOptions& options) {
  const auto quality = tracking::quality_of(table, features, options);
  return {{"features", names_of(features)}, {"wilks_lambda", quality.wilks_lambda}, {"accuracy", quality.accuracy}};
}

json ranked_json(const tracking::RankedFeature& f, std::size_t rank) {
  const auto& name = tracking::kFeatureNames[f.feature];
  json row{{"rank", rank},
           {"name", name.name},
           {"group", name.group},
           {"F_alone", f.F_alone},
           {"communality", f.communality},
           {"F_to_enter", nullptr},
           {"wilks_lambda", nullptr},
           {"redundant_with", nullptr}};
  if (f.redundant_with) {
    row["redundant_with"] = tracking::kFeatureNames[*f.redundant_with].name;
  } else {
    row["F_to_enter"] = f.F_to_enter;
    row["wilks_lambda"] = f.wilks_lambda;
  }
  return row;
}

std::string list(const json& names) {
  return fmt::format("{}", fmt::join(names.get<std::vector<std::string>>(), ", "));
}

std::vector<std::string> feature_cells(const json& f) {
  const bool redundant = !f["redundant_with"].is_null();
  return {std::to_string(f["rank"].get<int>()),
          f["name"],
          f["group"],
          fmt::format("{:.1f}", f["F_alone"].get<double>()),
          redundant ? "-" : fmt::format("{:.1f}", f["F_to_enter"].get<double>()),
          redundant ? "-" : fmt::format("{:.2e}", f["wilks_lambda"].get<double>()),
          fmt::format("{:.2f}", f["communality"].get<double>()),
          redundant ? "like " + f["redundant_with"].get<std::string>() : ""};
}

const std::vector<std::string> kColumns{"rank",       "feature",      "matrix", "F alone",
                                        "F to enter", "Wilks lambda", "in PCA", ""};

std::vector<std::vector<std::string>> set_rows(const json& s) {
  std::vector<std::vector<std::string>> rows;
  for (const char* set : {"chosen", "paper"})
    rows.push_back({set, fmt::format("{:.2e}", s[set]["wilks_lambda"].get<double>()),
                    fmt::format("{:.1f}", 100 * s[set]["accuracy"].get<double>()), list(s[set]["features"])});
  return rows;
}

// One region of each class after another, as columns.
cv::Mat examples(const std::vector<LabelledRegion>& regions, const json& classes) {
  constexpr int kTile = 96, kEach = 6;
  const int rows = static_cast<int>(classes.size());
  cv::Mat sheet(rows * kTile, kEach * kTile, CV_8UC1, cv::Scalar(255));
  for (int c = 0; c < rows; ++c) {
    int column = 0;
    for (const auto& region : regions) {
      if (column == kEach || region.label != classes[static_cast<std::size_t>(c)]["name"]) continue;
      cv::Mat tile;
      cv::resize(region.grey, tile, {kTile - 4, kTile - 4}, 0, 0, cv::INTER_NEAREST);
      tile.copyTo(sheet(cv::Rect(column++ * kTile, c * kTile, kTile - 4, kTile - 4)));
    }
  }
  return sheet;
}

}  // namespace

std::vector<LabelledRegion> regions_for(const SelectOptions& o) {
  if (o.csv.empty() == !o.simulated)
    throw ConfigError(o.simulated ? "give a CSV of regions or --simulated, not both"
                                  : "give a CSV (file,x,y,width,height,class), or --simulated for built-in regions");
  return o.simulated ? simulated_regions(static_cast<std::uint64_t>(o.seed), o.per_class)
                     : read_labelled_regions(o.csv);
}

json select_texture(const SelectOptions& o, const std::vector<LabelledRegion>& regions) {
  const std::string source = o.simulated ? "simulated heart" : o.csv;
  const tracking::FeatureTable table = feature_table(regions, o.texture);
  tracking::SelectionOptions options;
  options.count = o.count;
  options.max_correlation = o.max_correlation;
  if (const std::string why = tracking::problem_of(table, options); !why.empty()) throw InputError(source + ": " + why);
  const tracking::Selection selection = tracking::select_features(table, options);

  json result{{"command", "texture select"},
              {"version", HEARTSERVO_VERSION},
              {"source", source},
              {"samples", regions.size()},
              {"levels", o.texture.levels},
              {"distance", o.texture.distance},
              {"range", o.texture.range},
              {"constant", names_of(selection.constant)}};
  if (o.simulated) result["seed"] = o.seed;
  for (std::size_t c = 0; c < table.classes.size(); ++c)
    result["classes"].push_back({{"name", table.classes[c]},
                                 {"samples", std::count(table.label.begin(), table.label.end(), static_cast<int>(c))}});
  for (std::size_t k = 0; k < selection.ranking.size(); ++k)
    result["features"].push_back(ranked_json(selection.ranking[k], k + 1));
  for (const double share : selection.components.explained) result["explained"].push_back(share);
  result["components_kept"] = selection.components_kept;
  const auto& power = selection.discriminant.power;
  for (const double value : power)
    result["discriminant"].push_back({{"power", value},
                                      {"share", power.sum() > 0 ? value / power.sum() : 0},
                                      {"canonical_correlation", std::sqrt(value / (1 + value))}});
  const auto paper = tracking::paper_features();
  result["chosen"] = set_json(table, selection.chosen, options);
  result["paper"] = set_json(table, {paper.begin(), paper.end()}, options);
  result["overlap"] = json::array();
  for (const std::size_t k : selection.chosen)
    if (std::find(paper.begin(), paper.end(), k) != paper.end())
      result["overlap"].push_back(tracking::kFeatureNames[k].name);
  return result;
}

std::string select_text(const json& s) {
  std::string text = fmt::format("{} regions of {}:", s["samples"].get<int>(), s["source"].get<std::string>());
  for (const auto& c : s["classes"])
    text += fmt::format(" {} {}", c["samples"].get<int>(), c["name"].get<std::string>());
  text += fmt::format("\n\nPrincipal components: {} explain 95 % of the variance;", s["components_kept"].get<int>());
  for (std::size_t k = 0; k < std::min<std::size_t>(6, s["explained"].size()); ++k)
    text += fmt::format(" {:.1f}", 100 * s["explained"][k].get<double>());
  text += " ... %\nDiscriminant functions of the chosen:";
  for (const auto& d : s["discriminant"])
    text += fmt::format(" {:.1f} ({:.1f} %)", d["power"].get<double>(), 100 * d["share"].get<double>());
  constexpr const char* kRow = "\n{:>4}  {:<19}{:<14}{:>9}{:>12}{:>14}{:>8}  {}";
  text += "\n";
  const auto add = [&](const std::vector<std::string>& c) {
    text += fmt::format(fmt::runtime(kRow), c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]);
  };
  add(kColumns);
  for (const auto& feature : s["features"]) add(feature_cells(feature));
  if (!s["constant"].empty()) text += "\nthe same in every region, left out: " + list(s["constant"]);
  text += fmt::format("\n\n{:<8}{:>14}{:>14}  {}", "set", "Wilks lambda", "accuracy %", "features");
  for (const auto& row : set_rows(s)) text += fmt::format("\n{:<8}{:>14}{:>14}  {}", row[0], row[1], row[2], row[3]);
  return text + fmt::format("\n{} of the paper's eight are among the chosen{}{}\n", s["overlap"].size(),
                            s["overlap"].empty() ? "" : ": ", list(s["overlap"]));
}

Report select_report(const json& s, const std::vector<LabelledRegion>& regions) {
  Report report;
  report.title = "texture select";
  report.headline =
      fmt::format("{} features tell the {} classes apart in {:.1f} % of the regions; the paper's eight in {:.1f} %.",
                  s["chosen"]["features"].size(), s["classes"].size(), 100 * s["chosen"]["accuracy"].get<double>(),
                  100 * s["paper"]["accuracy"].get<double>());
  report.headline_number = fmt::format("{:.1f}", 100 * s["chosen"]["accuracy"].get<double>());
  report.headline_unit = "% of regions, leave one out";
  std::string classes;
  for (const auto& c : s["classes"]) classes += (classes.empty() ? "" : ", ") + c["name"].get<std::string>();
  report.pictures = {{"regions, a row a class: " + classes, examples(regions, s["classes"])}};
  ReportTable ranking{"Features, best first",
                      kColumns,
                      {},
                      "F alone: between over within classes; F to enter and Wilks' "
                      "lambda: given the features above; in PCA: share in the principal components kept"};
  for (const auto& feature : s["features"]) ranking.rows.push_back(feature_cells(feature));
  ReportTable components{"Principal components", {"component", "explained %"}, {}, ""};
  for (std::size_t k = 0; k < std::min<std::size_t>(10, s["explained"].size()); ++k)
    components.rows.push_back({std::to_string(k + 1), fmt::format("{:.2f}", 100 * s["explained"][k].get<double>())});
  report.tables = {
      {"Chosen, beside the paper's eight", {"set", "Wilks lambda", "accuracy %", "features"}, set_rows(s), ""},
      ranking,
      components};
  report.summary = s;
  return report;
}

}  // namespace heartservo::tools
