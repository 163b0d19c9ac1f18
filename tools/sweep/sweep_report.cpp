#include "tools/sweep/sweep_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "tools/servo_summary.hpp"
#include "tools/sweep/sweep_charts.hpp"
#include "tools/sweep/sweep_statistics.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;

ReportTable group_table(const SweepPlan& plan, const json& statistics) {
  ReportTable table{"Medians over the seeds, with 95 % intervals", {}, {}, "", true};
  for (const auto& axis : plan.axes)
    if (axis.key != "seed") table.header.push_back(axis.key);
  for (const char* name : {"runs", "stopped", "failed"}) table.header.emplace_back(name);
  for (const auto& metric : plan.metrics) table.header.push_back(metric);
  for (const json& group : statistics["groups"]) {
    std::vector<std::string> row;
    for (const auto& axis : plan.axes)
      if (axis.key != "seed") row.push_back(group["values"][axis.key]);
    for (const char* name : {"runs", "stopped", "failed"}) row.push_back(std::to_string(group[name].get<int>()));
    for (const auto& metric : plan.metrics) {
      const json& m = group["metrics"][metric];
      row.push_back(m["runs"] == 0   ? std::string("-")
                    : m["runs"] == 1 ? fmt::format("{:.4g}", m["median"].get<double>())
                                     : fmt::format("{:.4g} [{:.4g}, {:.4g}]", m["median"].get<double>(),
                                                   m["low"].get<double>(), m["high"].get<double>()));
    }
    table.rows.push_back(std::move(row));
  }
  table.note = "Intervals of the median by the bootstrap (2000 resamples); failed runs are left out of them.";
  return table;
}

ReportTable pair_table(const json& statistics) {
  ReportTable table{"Pairs on the same seeds",
                    {"axis", "a", "b", "everything else", "seeds", "median of a - b", "95 %", "a is less"},
                    {},
                    "",
                    true};
  for (const json& p : statistics["pairs"]) {
    std::string others;
    for (const auto& [key, value] : p["others"].items())
      others += fmt::format("{}{} {}", others.empty() ? "" : ", ", key, value.get<std::string>());
    table.rows.push_back({p["axis"], p["a"], p["b"], others, std::to_string(p["seeds"].get<int>()),
                          fmt::format("{:.4g}", p["median_difference"].get<double>()),
                          fmt::format("[{:.4g}, {:.4g}]", p["low"].get<double>(), p["high"].get<double>()),
                          fmt::format("{:.0f} %", 100 * p["a_is_less"].get<double>())});
    table.note = "Of " + p["metric"].get<std::string>() + ".";
  }
  return table;
}

// The setting with the least of the first metric, where less is better.
void name_the_best(const SweepPlan& plan, const json& summary, Report& report) {
  const std::string& metric = plan.metrics[0];
  const json* best = nullptr;
  if (!metric.starts_with("residual.") && !metric.starts_with("tracking.")) return;
  for (const json& group : summary["groups"])
    if (const json& m = group["metrics"][metric];
        m["runs"] > 0 && (best == nullptr || m["median"] < (*best)["metrics"][metric]["median"]))
      best = &group;
  if (best == nullptr || summary["groups"].size() < 2) return;
  std::string setting;
  for (const auto& axis : plan.axes)
    if (axis.key != "seed")
      setting +=
          fmt::format("{}{} {}", setting.empty() ? "" : ", ", axis.key, (*best)["values"][axis.key].get<std::string>());
  report.headline += fmt::format(" The least is left with {}.", setting);
  report.headline_number = number((*best)["metrics"][metric]["median"], 3);
  report.headline_unit = metric;
}

}  // namespace

bool is_sweep(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::is_regular_file(folder / "results.json", error);
}

StoredSweep read_swept(const std::filesystem::path& folder) {
  const auto fail = [&](const char* why) {
    throw InputError(fmt::format("{}: {}", (folder / "results.json").string(), why));
  };
  std::ifstream in(folder / "results.json");
  const json j = json::parse(in, nullptr, false);
  if (!j.is_object() || j.value("command", "") != "sweep") fail("is not a sweep's");
  StoredSweep stored;
  try {
    stored.plan.file = j.at("sweep");
    stored.plan.title = j.at("title");
    stored.plan.metrics = j.at("metrics");
    for (const json& axis : j.at("axes"))
      stored.plan.axes.push_back({axis.at("key"), axis.at("values"), axis.at("numeric")});
  } catch (const json::exception&) {
    fail("lacks axes or metrics; run the sweep's command again, which repeats no run");
  }
  if (stored.plan.metrics.empty()) fail("has no metrics");
  stored.results = read_results(folder / "results.csv", stored.plan);
  return stored;
}

json sweep_summary(const SweepPlan& plan, const SweepResults& results) {
  json summary = sweep_statistics(plan, results);
  summary["command"] = "sweep";
  summary["version"] = HEARTSERVO_VERSION;
  summary["sweep"] = plan.file;
  summary["title"] = plan.title;
  summary["metrics"] = plan.metrics;
  for (const auto& axis : plan.axes)
    summary["axes"].push_back({{"key", axis.key}, {"values", axis.values}, {"numeric", axis.numeric}});
  summary["runs"] = plan.runs();
  summary["done"] = results.size();
  summary["failed"] =
      std::count_if(results.begin(), results.end(), [](const auto& r) { return r.second.status == "failed"; });
  return summary;
}

Report sweep_report(const SweepPlan& plan, const SweepResults& results, const json& summary) {
  Report report;
  const int failed = summary["failed"];
  report.title = plan.title.empty() ? "sweep " + std::filesystem::path(plan.file).stem().string() : plan.title;
  report.headline = fmt::format("{} of {} runs are done{}.", results.size(), plan.runs(),
                                failed > 0 ? fmt::format(", {} of them failed", failed) : "");
  name_the_best(plan, summary, report);
  report.charts = sweep_charts(plan, results);
  report.tables = {group_table(plan, summary)};
  if (!summary["pairs"].empty()) report.tables.push_back(pair_table(summary));
  if (failed > 0) {
    ReportTable failures{"Failed runs", {"run", "error"}, {}, "Run the sweep again with --retry to repeat them.", true};
    for (const auto& [run, r] : results)
      if (r.status == "failed" && failures.rows.size() < 50) failures.rows.push_back({std::to_string(run), r.error});
    report.tables.push_back(failures);
  }
  report.summary = summary;
  return report;
}

}  // namespace heartservo::tools
