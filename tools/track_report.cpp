#include "tools/track_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tools/servo_summary.hpp"
#include "tools/track_tables.hpp"
#include "tools/window/selection.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;

// Less than this is as good as nothing: the floor of the logarithmic axes.
constexpr double kLeastError_px = 0.001, kLeastTime_ms = 0.01;

// The lane of the fewest frames lost or wrong, then of the smallest error.
const json& best_of(const json& lanes) {
  const auto rank = [](const json& lane) {
    const json &bad = lane["score_lost_frames"], &error = lane["error_px"], &point = lane["point_error_px"];
    return std::pair(bad.is_null() ? lane["lost_frames"].get<int>() : bad.get<int>(),
                     !error.is_null()                                 ? error["mean"].get<double>()
                     : !point.is_null() && !point["median"].is_null() ? point["median"].get<double>()
                                                                      : 0.0);
  };
  const json* best = &lanes[0];
  for (const json& lane : lanes)
    if (rank(lane) < rank(*best)) best = &lane;
  return *best;
}

void answer(Report& report, const json& summary) {
  const json &lanes = summary["trackers"], &best = best_of(lanes);
  const std::string name = best["name"];
  const int lost = best["lost_frames"], frames = summary["frames"];
  report.headline = fmt::format("{} followed the region in {} of {} frames{}.", name, frames - lost, frames,
                                lanes.size() > 1 ? fmt::format(", best of {} trackers", lanes.size()) : "");
  const json &error = best["error_px"], &point = best["point_error_px"];
  if (!error.is_null()) {
    report.headline_number = number(error["mean"], 3);
    report.headline_unit = "px mean corner error";
  } else if (!point.is_null() && !point["median"].is_null()) {
    report.headline_number = number(point["median"], 2);
    report.headline_unit = "px median error of the point";
    report.headline += fmt::format(
        " The annotated point{} stays within {} px of the carried one in 95 % of the {} frames in which it can be "
        "scored.",
        point["name"] == "" ? "" : " " + point["name"].get<std::string>(), number(point["p95"], 2),
        point["frames"].get<int>());
  } else {
    report.headline_number = std::to_string(lost);
    report.headline_unit = "lost frames";
  }
  if (summary["interrupted"].get<bool>()) report.notices.emplace_back("Ended early by Ctrl-C or q.");
  if (const std::string selected = selection_notice(summary); !selected.empty()) report.notices.push_back(selected);
  for (const json& lane : lanes)
    if (lane["wrong_ok_frames"].is_number() && lane["wrong_ok_frames"] > 0)
      report.notices.push_back(fmt::format("{} called {} frame{} OK in which it was wrong.",
                                           lane["name"].get<std::string>(), lane["wrong_ok_frames"].get<int>(),
                                           lane["wrong_ok_frames"] == 1 ? "" : "s"));
}

}  // namespace

TimeTable side_by_side(const std::vector<TrackLane>& lanes) {
  const TimeTable& first = lanes.front().table();
  std::vector<std::string> names{"time_s"};
  std::vector<std::vector<double>> columns{{first.time_s().begin(), first.time_s().end()}};
  const auto add = [&](const std::string& name, std::vector<double> values) {
    names.push_back(name);
    columns.push_back(std::move(values));
  };
  const auto copied = [](std::span<const double> values, double less = 0) {
    std::vector<double> copy(values.begin(), values.end());
    for (double& v : copy) v -= less;
    return copy;
  };
  // lanes of several regions have no truth in common: displacements of their centres then
  const bool one_region = lanes.front().began().number == 0;
  const bool corners = first.has("truth/corner0/u_px"), point = first.has("point/u_px") && one_region;
  const Eigen::Vector2d& start = lanes.front().began().point;
  // columns u_px, v_px of `group` as displacements of the point
  const auto add_moved = [&](const std::string& name, const TimeTable& t, const std::string& group) {
    add(name + "/u_px", copied(t.column(group + "/u_px"), start.x()));
    add(name + "/v_px", copied(t.column(group + "/v_px"), start.y()));
  };
  if (point) add_moved("truth", first, "truth/point");
  for (const auto& lane : lanes) {
    const TimeTable& t = lane.table();
    if (point) {
      add_moved(lane.name(), t, "point");
    } else {
      add(lane.name() + "/u_px", copied(t.column("displacement/u_px")));
      add(lane.name() + "/v_px", copied(t.column("displacement/v_px")));
    }
    if (corners || point) add(lane.name() + "/error_px", copied(t.column(corners ? "error_px" : "point/error_px")));
    if (t.has("measured/z_m")) add(lane.name() + "/z_m", copied(t.column("measured/z_m")));
    add(lane.name() + "/quality", copied(t.column("track/quality")));
    add(lane.name() + "/state", copied(t.column("track/state")));
    add(lane.name() + "/ms", copied(t.column("timing/track_ms")));
  }
  TimeTable result(names, first.rows());
  std::vector<double> row(columns.size());
  for (std::size_t i = 0; i < first.rows(); ++i) {
    for (std::size_t c = 0; c < columns.size(); ++c) row[c] = columns[c][i];
    result.append(row);
  }
  return result;
}

Report track_report(const json& summary, const TimeTable& table, std::vector<ReportTable> paper,
                    std::vector<ReportPicture> pictures, const std::string& config_yaml) {
  Report report;
  report.title = "track " + summary["source"].get<std::string>();
  answer(report, summary);
  const auto series = [&](const std::string& column) {
    std::vector<ReportSeries> all;
    for (const json& lane : summary["trackers"]) {
      const std::string name = lane["name"];
      all.push_back({name, name + "/" + column});
    }
    return all;
  };
  const bool point = table.has("truth/u_px");
  const bool depth = table.has(summary["trackers"][0]["name"].get<std::string>() + "/z_m");
  const auto displacement = [&](const char* title, const char* column) {
    ReportPlot plot{title, "px", series(column), 1, point ? "" : "Of the region's centre since the first frame."};
    if (!point) return plot;
    const std::string name = summary["point"];
    plot.note = name == "target"
                    ? "Of the region's true centre since the first frame."
                    : fmt::format("Of the annotated point{} since the first frame, as each tracker carries it.",
                                  name.empty() ? "" : " " + name);
    plot.series.insert(plot.series.begin(), {"truth", fmt::format("truth/{}", column), true});
    return plot;
  };
  const json& first = summary["trackers"][0];
  const bool corners = first["wrong_over_px"].is_object() && first["wrong_over_px"].contains("corners");
  report.plots = {displacement("Vertical displacement", "v_px")};
  if (corners || point)
    report.plots.push_back({"Error", "px", series("error_px"), 1,
                            corners
                                ? "Mean distance of the four corners from the true ones; a gap where LOST."
                                : "Distance of the point, as carried, from where it was annotated; a gap where LOST "
                                  "or not visible.",
                            nullptr, kLeastError_px});
  report.plots.push_back(displacement("Horizontal displacement", "u_px"));
  if (depth) report.plots.push_back({"Depth", "mm", series("z_m"), 1e3, "Of the region's centre."});
  report.plots.push_back({"Quality", "", series("quality"), 1, "", nullptr});
  report.plots.push_back({"Computing time", "ms", series("ms"), 1, "", nullptr, kLeastTime_ms});
  report.states = series("state");
  report.tables = {tracker_table(summary)};
  report.tables.insert(report.tables.end(), paper.begin(), paper.end());
  report.pictures = std::move(pictures);
  report.table = &table;
  report.config_yaml = config_yaml;
  report.summary = summary;
  return report;
}

}  // namespace heartservo::tools
