// heartservo beats: the R peaks of an ECG, found as they would be in a loop, and scored against labels.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "servo/ecg/beat_score.hpp"
#include "servo/ecg/ecg_record.hpp"
#include "servo/ecg/r_peak_detector.hpp"
#include "servo/loop/score.hpp"
#include "tools/command.hpp"
#include "tools/report/report.hpp"
#include "tools/run_folder.hpp"
#include "tools/servo_summary.hpp"
#include "tools/time_table.hpp"
#include "tools/track_tables.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;

struct BeatsOptions {
  RunOptions run;
  std::string lead, labels;
  double window_ms = 50;
};

std::vector<servo::RPeak> peaks_of(const servo::EcgRecord& record) {
  servo::RPeakDetector detector(record.rate_hz);
  std::vector<servo::RPeak> peaks;
  for (std::size_t i = 0; i < record.value.size(); ++i)
    if (const auto peak = detector.next(record.time_s(i), record.value[i])) peaks.push_back(*peak);
  return peaks;
}

json rates(const std::vector<servo::RPeak>& peaks) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < peaks.size(); ++i) intervals.push_back(peaks[i].time_s - peaks[i - 1].time_s);
  if (intervals.empty()) return nullptr;
  const auto spread = servo::spread_of(intervals);
  return {{"mean", 1e3 * spread.mean},
          {"std", 1e3 * spread.std},
          {"min", 1e3 * servo::percentile(intervals, 0)},
          {"max", 1e3 * servo::percentile(intervals, 100)}};
}

json score_json(const servo::BeatScore& s, const std::string& labels, double window_ms) {
  return {
      {"file", labels},
      {"labels", s.labels},
      {"matched", s.matched},
      {"window_ms", window_ms},
      {"sensitivity_percent", s.sensitivity_percent()},
      {"positive_predictivity_percent", s.positive_predictivity_percent()},
      {"error_ms", {{"mean", 1e3 * s.mean_error_s}, {"std", 1e3 * s.sigma_error_s}, {"max", 1e3 * s.largest_error_s}}}};
}

json summary_of(const servo::EcgRecord& record, const std::vector<servo::RPeak>& peaks) {
  double delay = 0, longest = 0;
  std::size_t looked_back = 0;
  for (const auto& peak : peaks) {
    double& which = peak.looked_back ? longest : delay;
    which = std::max(which, peak.known_s - peak.time_s);
    looked_back += peak.looked_back;
  }
  return {{"command", "beats"},
          {"version", HEARTSERVO_VERSION},
          {"file", record.file},
          {"lead", record.lead},
          {"rate_hz", record.rate_hz},
          {"duration_s", record.duration_s()},
          {"beats", peaks.size()},
          {"interval_ms", rates(peaks)},
          {"delay_ms", 1e3 * delay},
          {"looked_back", looked_back},
          {"looked_back_delay_ms", looked_back > 0 ? json(1e3 * longest) : json(nullptr)},
          {"score", nullptr}};
}

ReportTable table_of(const json& s) {
  ReportTable table{"Beats", {}, {}, ""};
  const auto add = [&](const char* name, const std::string& value) { table.rows.push_back({name, value}); };
  add("lead", s["lead"]);
  add("beats", number(s["beats"], 0));
  if (!s["interval_ms"].is_null())
    add("interval ms, mean ± std", number(s["interval_ms"]["mean"], 1) + " ± " + number(s["interval_ms"]["std"], 1));
  add("known after ms, at most", number(s["delay_ms"], 1));
  add("looked back for", number(s["looked_back"], 0));
  if (!s["score"].is_null()) {
    const json& score = s["score"];
    add("labels", number(score["labels"], 0));
    add("sensitivity %", number(score["sensitivity_percent"], 3));
    add("positive predictivity %", number(score["positive_predictivity_percent"], 3));
    add("time error ms, mean ± std",
        number(score["error_ms"]["mean"], 2) + " ± " + number(score["error_ms"]["std"], 2));
  }
  table.note =
      "Known after: from an R peak until the detector, which sees no sample before its time, reports it. Looked back "
      "for: found later, at the start or in a pause.";
  return table;
}

// The ECG, and the R peaks on it.
TimeTable ecg_table(const servo::EcgRecord& record, const std::vector<servo::RPeak>& peaks) {
  TimeTable table({"time_s", "ecg", "r_peak"}, record.value.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < record.value.size(); ++i) {
    const bool here = next < peaks.size() && peaks[next].time_s <= record.time_s(i) + 0.5 / record.rate_hz;
    table.append({record.time_s(i), record.value[i], here ? record.value[i] : NAN});
    if (here) ++next;
  }
  return table;
}

int run_beats(const BeatsOptions& o) {
  if (o.run.source.empty())
    throw ConfigError("ECG is missing: give a WFDB record (.hea) or a CSV with time_s and leads");
  const servo::EcgRecord record = servo::read_ecg(o.run.source, o.lead);
  const auto peaks = peaks_of(record);
  json summary = summary_of(record, peaks);
  const std::string labels = o.labels.empty() ? annotations_of(record) : o.labels;
  TimeTable beats({"time_s", "known_s", "looked_back"}, peaks.size());
  for (const auto& peak : peaks) beats.append({peak.time_s, peak.known_s, peak.looked_back ? 1.0 : 0.0});
  if (!labels.empty()) {
    const std::vector<double> found(beats.time_s().begin(), beats.time_s().end());
    const auto score =
        servo::score_beats(found, servo::read_annotated_beats(labels, record.rate_hz), 1e-3 * o.window_ms);
    summary["score"] = score_json(score, labels, o.window_ms);
  }
  RunFolder folder(run_path(o.run, "beats"));
  beats.write_csv(folder.file("beats.csv"));
  Report report;
  report.title = "beats " + o.run.source;
  report.headline = fmt::format("{} beats in {:.0f} s of lead {}.", peaks.size(), record.duration_s(), record.lead);
  report.headline_number = std::to_string(peaks.size());
  report.headline_unit = "beats";
  constexpr double kLongestPlot_s = 300;  // a page of half an hour of samples is too heavy to open
  servo::EcgRecord shown = record;
  shown.value.resize(std::min(shown.value.size(), static_cast<std::size_t>(kLongestPlot_s * record.rate_hz)));
  const TimeTable ecg = ecg_table(shown, peaks);
  report.table = &ecg;
  report.plots = {{"ECG",
                   record.unit,
                   {{record.lead, "ecg"}, {"R peak", "r_peak"}},
                   1,
                   shown.value.size() < record.value.size() ? "The first 300 s." : ""}};
  report.tables = {table_of(summary)};
  report.config_yaml =
      fmt::format("# heartservo {} beats\nrecord: {}\nlead: {}\nlabels: {}\nwindow_ms: {}\n", HEARTSERVO_VERSION,
                  json(std::filesystem::absolute(record.file).string()).dump(), json(record.lead).dump(),
                  json(labels.empty() ? "" : std::filesystem::absolute(labels).string()).dump(), o.window_ms);
  report.summary = summary;
  finish_run(folder, report, o.run, fmt::format("{}\n\n{}", report.headline, terminal_text(report.tables[0], true)));
  return DONE;
}

}  // namespace

Command add_beats_command(CLI::App& program) {
  auto options = std::make_shared<BeatsOptions>();
  BeatsOptions& o = *options;
  CLI::App* app = program.add_subcommand("beats", "R peaks of an ECG, found on line");
  app->add_option("ecg", o.run.source, "WFDB record (.hea; formats 212, 16), or CSV with time_s and a column a lead");
  app->add_option("--lead", o.lead, "which lead (default: the first ECG)")->type_name("NAME");
  app->add_option("--labels", o.labels,
                  "score against these beats: WFDB annotations or CSV (default: .atr beside the record, if there)")
      ->type_name("FILE");
  app->add_option("--window-ms", o.window_ms, "how far a beat may lie from its label (default 50)")
      ->check(finite(1, 500));
  app->add_option("--out", o.run.out, "run folder (default: runs/beats-NAME-DATE)")->type_name("DIR");
  app->add_flag("--json", o.run.json, "print summary.json on stdout and nothing else");
  app->add_flag("--quiet", o.run.quiet, "no table");
  app->footer(
      "Example: heartservo beats ECG.hea --lead MLII\n"
      "The run folder holds beats.csv (time_s and when each beat was known), which 'heartservo predict --beats' "
      "reads.");
  return {app, [options] { return run_beats(*options); }};
}

}  // namespace heartservo::tools
