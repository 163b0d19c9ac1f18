#include "tools/run_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tools/servo_summary.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;

// What is worth a plot, when a run has it: title, column, unit shown, scale.
struct Plotted {
  const char *title, *column, *unit;
  double scale;
};
constexpr Plotted kPlots[] = {
    {"Distance of the tip from its goal", "residual/norm_m", "mm", 1e3},
    {"Distance in the picture", "residual/norm_px", "px", 1},
    {"Depth of the target", "measured/z_m", "mm", 1e3},
    {"Corner error", "error_px", "px", 1},
    {"Place of the region in the still view, u", "still/u_px", "px", 1},
    {"Vertical displacement", "displacement/v_px", "px", 1},
    {"Horizontal displacement", "displacement/u_px", "px", 1},
    {"Quality", "track/quality", "", 1},
    {"Computing time", "timing/chain_ms", "ms", 1},
    {"Tracking time", "timing/track_ms", "ms", 1},
};

// "residual.rms_mm" -> text; lists are counted through.
void flatten(const json& value, const std::string& path, std::map<std::string, std::string>& out,
             std::vector<std::string>& order) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items()) flatten(inner, path.empty() ? key : path + "." + key, out, order);
    return;
  }
  if (value.is_array()) {
    for (std::size_t i = 0; i < value.size() && i < 32; ++i)
      flatten(value[i], fmt::format("{}.{}", path, i), out, order);
    return;
  }
  const std::string text = value.is_number_float() ? fmt::format("{:.4g}", value.get<double>())
                           : value.is_string()     ? value.get<std::string>()
                           : value.is_null()       ? "-"
                                                   : value.dump();
  if (out.emplace(path, text).second && std::find(order.begin(), order.end(), path) == order.end())
    order.push_back(path);
}

// The number that answers the question of such a run; null where there is none.
json answer_of(const json& s) {
  for (const char* path : {"/residual/rms_mm", "/residual_px/rms", "/trackers/0/error_px/mean", "/motion_px/still"}) {
    const json::json_pointer pointer(path);
    if (s.contains(pointer) && s[pointer].is_number()) return s[pointer];
  }
  return nullptr;
}

bool has(const std::vector<StoredRun>& runs, const std::string& column) {
  return std::any_of(runs.begin(), runs.end(), [&](const StoredRun& r) { return r.frames && r.frames->has(column); });
}

}  // namespace

std::vector<std::string> labels_of(const std::vector<StoredRun>& runs) {
  std::map<std::string, int> count, used;
  for (const auto& run : runs) ++count[run.name];
  std::vector<std::string> labels;
  for (const auto& run : runs)
    labels.push_back(count[run.name] == 1 ? run.name : fmt::format("{} ({})", run.name, ++used[run.name]));
  for (auto& label : labels)
    std::replace_if(
        label.begin(), label.end(), [](char c) { return c == ',' || c == '"'; }, '_');
  return labels;
}

std::vector<std::string> compared_columns(const std::vector<StoredRun>& runs) {
  std::vector<std::string> columns;
  for (const auto& p : kPlots)
    if (has(runs, p.column)) columns.emplace_back(p.column);
  if (has(runs, "goal/truth/z_m")) columns.emplace_back("goal/truth/z_m");
  return columns;
}

TimeTable together(const std::vector<StoredRun>& runs, const std::vector<std::string>& columns) {
  const auto labels = labels_of(runs);
  const StoredRun* longest = nullptr;
  for (const auto& run : runs)
    if (run.frames && (longest == nullptr || run.frames->rows() > longest->frames->rows())) longest = &run;
  std::vector<std::string> names{"time_s"};
  struct Source {
    std::span<const double> time, values;
  };
  std::vector<Source> sources;
  for (std::size_t i = 0; i < runs.size(); ++i)
    for (const auto& column : columns)
      if (runs[i].frames && runs[i].frames->has(column)) {
        names.push_back(labels[i] + "/" + column);
        sources.push_back({runs[i].frames->time_s(), runs[i].frames->column(column)});
      }
  TimeTable table(names, longest != nullptr ? longest->frames->rows() : 0);
  if (longest == nullptr) return table;
  std::vector<double> row(names.size());
  for (const double t : longest->frames->time_s()) {
    row[0] = t;
    for (std::size_t c = 0; c < sources.size(); ++c) {
      const auto& [time, values] = sources[c];
      const auto after = static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), t) - time.begin());
      std::size_t nearest = std::min(after, time.size() - 1);
      if (after > 0 && (after == time.size() || t - time[after - 1] < time[after] - t)) nearest = after - 1;
      const double period = time.size() > 1 ? (time.back() - time.front()) / static_cast<double>(time.size() - 1) : 1;
      row[c + 1] = std::abs(time[nearest] - t) <= period ? values[nearest] : NAN;
    }
    table.append(row);
  }
  return table;
}

ReportTable summary_table(const std::vector<StoredRun>& runs, bool differing) {
  std::vector<std::string> order;
  std::vector<std::map<std::string, std::string>> texts(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) flatten(runs[i].summary, "", texts[i], order);
  ReportTable table{differing ? "What differs" : "Summary", {"summary.json"}, {}, "", true};
  for (const auto& label : labels_of(runs)) table.header.push_back(label);
  for (const auto& path : order) {
    std::vector<std::string> row{path};
    for (const auto& text : texts) row.push_back(text.contains(path) ? text.at(path) : "-");
    const bool same = std::all_of(row.begin() + 2, row.end(), [&](const std::string& cell) { return cell == row[1]; });
    if (!differing || !same) table.rows.push_back(row);
  }
  return table;
}

Report comparison_report(const std::vector<StoredRun>& runs, const TimeTable& table) {
  Report report;
  const auto labels = labels_of(runs);
  report.title = fmt::format("{} runs of {}", runs.size(), runs.front().command());
  std::size_t best = 0;
  bool known = true;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const json a = answer_of(runs[i].summary), b = answer_of(runs[best].summary);
    known = known && !a.is_null();
    if (known && a.get<double>() < b.get<double>()) best = i;
    if (!runs[i].frames) report.notices.push_back(fmt::format("{} has no frames.", labels[i]));
    if (runs[i].summary.value("interrupted", false))
      report.notices.push_back(labels[i] + " was ended early by Ctrl-C.");
    if (runs[i].summary.contains("stop_reason") && runs[i].summary["stop_reason"].is_string())
      report.notices.push_back(
          fmt::format("{}: safety stop: {}", labels[i], runs[i].summary["stop_reason"].get<std::string>()));
  }
  report.headline = fmt::format("{} runs side by side.", runs.size());
  if (known) {
    const bool metric = runs[best].summary.contains("residual") && runs[best].summary["residual"].is_object();
    report.headline = fmt::format("The least of {} runs is left by {}.", runs.size(), labels[best]);
    report.headline_number = number(answer_of(runs[best].summary), metric ? 3 : 2);
    report.headline_unit = metric ? "mm RMS residual" : "px";
  }
  for (const auto& p : kPlots) {
    ReportPlot plot{p.title, p.unit, {}, p.scale};
    if (std::string(p.column) == "residual/norm_m" && table.has(labels.front() + "/goal/truth/z_m"))
      plot.note = "Of the true tip from the true goal.";
    for (const auto& label : labels)
      if (table.has(label + "/" + p.column)) plot.series.push_back({label, label + "/" + p.column});
    if (!plot.series.empty()) report.plots.push_back(plot);
  }
  report.tables = {summary_table(runs, true)};
  report.table = &table;
  for (const auto& run : runs) report.summary["runs"].push_back(run.summary);
  report.summary["command"] = "report";
  report.summary["version"] = HEARTSERVO_VERSION;
  return report;
}

}  // namespace heartservo::tools
