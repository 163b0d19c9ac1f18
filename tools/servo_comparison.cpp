#include "tools/servo_comparison.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tools/servo_summary.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;

json row_of(const std::string& predictor, const std::string& controller, const json& summary) {
  json row{{"predictor", predictor}, {"controller", controller}};
  for (const char* key : {"residual", "residual_px", "reduction_percent", "stop_reason"}) row[key] = summary[key];
  row["limited"] = summary["commands"]["limited"];
  return row;
}

double badness(const ServoOutcome& o) {
  const json& r = o.summary["residual"].is_null() ? o.summary["residual_px"]["rms"] : o.summary["residual"]["rms_mm"];
  return !o.stop_reason.empty() || !r.is_number() ? INFINITY : r.get<double>();
}

std::vector<std::string> cells(const json& row) {
  const bool metric = !row["residual"].is_null();
  const json& r = metric ? row["residual"] : row["residual_px"];
  const int decimals = metric ? 3 : 2;
  std::vector<std::string> c{row["predictor"].get<std::string>(), row["controller"].get<std::string>()};
  for (const char* key : {"rms", "p95", "max"})
    c.push_back(number(r[std::string(key) + (metric ? "_mm" : "")], decimals));
  c.push_back(row["stop_reason"].is_null() ? number(row["reduction_percent"], 1) : "stopped");
  return c;
}

}  // namespace

ServoComparison compare(const ServoRequest& request, const std::vector<std::string>& predictors,
                        const std::vector<std::string>& controllers) {
  ServoComparison comparison;
  double least = INFINITY;
  for (const auto& predictor : predictors)
    for (const auto& controller : controllers) {
      ServoRequest one = request;
      one.scene.engines.predictor = predictor;
      one.scene.engines.controller = controller;
      one.label = fmt::format("{} + {}", predictor, controller);
      ServoOutcome outcome = run_loop(one);
      comparison.rows.push_back(row_of(predictor, controller, outcome.summary));
      comparison.interrupted = outcome.interrupted;
      const bool first = comparison.rows.size() == 1;
      if (first || badness(outcome) < least) {
        least = badness(outcome);
        comparison.best = std::move(outcome);
      }
      if (comparison.interrupted) return comparison;
    }
  return comparison;
}

ReportTable comparison_table(const json& rows) {
  const bool metric = !rows.empty() && !rows[0]["residual"].is_null();
  ReportTable table{"Predictors and control laws side by side",
                    {"predictor", "control law", metric ? "RMS, mm" : "RMS, px", "95 %", "max", "cancelled, %"},
                    {},
                    "Everything else is as in the scene; the rest of this page is about the best of them."};
  for (const auto& row : rows) table.rows.push_back(cells(row));
  return table;
}

std::string comparison_text(const json& rows) {
  const ReportTable table = comparison_table(rows);
  std::string text;
  const auto line = [&](const std::vector<std::string>& c) {
    text += fmt::format("{:<24}{:<20}", c[0], c[1]);
    for (std::size_t i = 2; i < c.size(); ++i) text += fmt::format("{:>14}", c[i]);
    text += "\n";
  };
  line(table.header);
  for (const auto& row : table.rows) line(row);
  return text;
}

}  // namespace heartservo::tools
