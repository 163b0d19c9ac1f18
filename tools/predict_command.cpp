// heartservo predict: predictors side by side on a recorded motion.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "servo/motion/motion_record.hpp"
#include "servo/motion/prediction_score.hpp"
#include "servo/prediction/registry.hpp"
#include "tools/command.hpp"
#include "tools/interrupt.hpp"
#include "tools/progress.hpp"
#include "tools/report/report.hpp"
#include "tools/run_folder.hpp"
#include "tools/track_tables.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

struct PredictOptions {
  RunOptions run;
  std::vector<std::string> predictors{"all"};
  std::vector<double> horizons_ms{8, 16, 32, 64, 128};
  double settle_s = 30;
  bool settle_given = false;
  std::string beats, points;
};

std::vector<std::string> chosen_predictors(const PredictOptions& o) {
  std::vector<std::string> names = o.predictors;
  if (names == std::vector<std::string>{"all"}) names = servo::predictors().names();
  for (const auto& name : names) {
    servo::predictors().require(name);
    if (std::count(names.begin(), names.end(), name) > 1)
      throw ConfigError(fmt::format("--predictor: '{}' is given twice; keep one", name));
  }
  return names;
}

servo::ScoreOptions score_options(const PredictOptions& o, const servo::MotionRecord& record) {
  servo::ScoreOptions options;
  for (const double ms : o.horizons_ms) options.horizons_s.push_back(1e-3 * ms);
  std::sort(options.horizons_s.begin(), options.horizons_s.end());
  if (std::adjacent_find(options.horizons_s.begin(), options.horizons_s.end()) != options.horizons_s.end())
    throw ConfigError("--horizons-ms: a horizon is given twice; keep one");
  const double length = record.time_s.back() - record.time_s.front();
  options.settle_s = o.settle_given ? o.settle_s : std::min(o.settle_s, length / 3);
  if (!(options.settle_s + options.horizons_s.front() <= length))
    throw ConfigError(fmt::format("{}: {:.3g} s long; nothing is left to be scored after --settle-s {:g} at {:g} ms",
                                  record.file, length, options.settle_s, 1e3 * options.horizons_s.front()));
  if (!o.beats.empty()) options.r_peaks_s = servo::read_beats(o.beats);
  return options;
}

nlohmann::json summary_of(const std::string& name, const servo::PredictionScore& score) {
  nlohmann::json j{{"name", name}, {"horizons", nlohmann::json::array()}, {"unlocks", score.unlocks}};
  const auto mm = [](double m) { return std::isfinite(m) ? nlohmann::json(1e3 * m) : nlohmann::json(nullptr); };
  for (const auto& h : score.horizons)
    j["horizons"].push_back({{"ms", 1e3 * h.horizon_s},
                             {"rms_mm",
                              {{"x", mm(h.axis_rms_m.x())},
                               {"y", mm(h.axis_rms_m.y())},
                               {"z", mm(h.axis_rms_m.z())},
                               {"norm", mm(h.rms_m)}}},
                             {"p99_mm", mm(h.p99_m)},
                             {"max_mm", mm(h.max_m)},
                             {"scored", h.scored}});
  return j;
}

ReportTable table_of(const nlohmann::json& summary) {
  ReportTable table{"Prediction error, mm",
                    {"predictor", "horizon, ms", "x RMS", "y RMS", "z RMS", "3D RMS", "99 %", "max", "unlocks"},
                    {},
                    fmt::format("Scored on the {} {} s after the start; unlocks: over 3 mm for a beat.",
                                summary["reference"].get<std::string>(), summary["settle_s"].get<double>())};
  const auto text = [](const nlohmann::json& v) { return v.is_null() ? "-" : fmt::format("{:.3f}", v.get<double>()); };
  for (const auto& p : summary["predictors"]) {
    bool first = true;
    for (const auto& h : p["horizons"]) {
      const auto& rms = h["rms_mm"];
      table.rows.push_back({first ? p["name"].get<std::string>() : "", fmt::format("{:g}", h["ms"].get<double>()),
                            text(rms["x"]), text(rms["y"]), text(rms["z"]), text(rms["norm"]), text(h["p99_mm"]),
                            text(h["max_mm"]), first ? std::to_string(p["unlocks"].get<int>()) : ""});
      first = false;
    }
  }
  return table;
}

// The horizon that the plots show: the longest up to 64 ms, or the shortest.
std::size_t shown_horizon(const std::vector<double>& horizons_s) {
  std::size_t shown = 0;
  for (std::size_t h = 0; h < horizons_s.size(); ++h)
    if (horizons_s[h] <= 0.0641) shown = h;
  return shown;
}

std::string config_of(const PredictOptions& o, const std::vector<std::string>& names, const nlohmann::json& summary) {
  return fmt::format(
      "# heartservo {} predict\nmotion: \"{}\"\npoints: \"{}\"\nbeats: \"{}\"\npredictors: [{}]\n"
      "horizons_ms: [{}]\nsettle_s: {}\n",
      HEARTSERVO_VERSION, o.run.source, summary["points"].get<std::string>(), o.beats, fmt::join(names, ", "),
      fmt::join(o.horizons_ms, ", "), summary["settle_s"].get<double>());
}

Report report_of(const nlohmann::json& summary, const std::vector<std::string>& names, double shown_s,
                 const TimeTable& table) {
  Report report;
  report.title = "predict " + stem_of(summary["source"].get<std::string>());
  const auto at = [&](const nlohmann::json& p) {
    for (const auto& h : p["horizons"])
      if (std::abs(h["ms"].get<double>() - 1e3 * shown_s) < 1e-6 && !h["rms_mm"]["norm"].is_null())
        return h["rms_mm"]["norm"].get<double>();
    return static_cast<double>(INFINITY);
  };
  const auto& all = summary["predictors"];
  const auto best = std::min_element(all.begin(), all.end(), [&](auto& a, auto& b) { return at(a) < at(b); });
  report.headline = fmt::format("{} foresees the motion {:g} ms ahead best: {:.3f} mm RMS.",
                                (*best)["name"].get<std::string>(), 1e3 * shown_s, at(*best));
  report.headline_number = fmt::format("{:.3f}", at(*best));
  report.headline_unit = fmt::format("mm RMS at {:g} ms", 1e3 * shown_s);
  ReportPlot errors{fmt::format("Distance of what was foreseen {:g} ms before", 1e3 * shown_s), "mm", {}, 1e3};
  ReportPlot z{"z, and what was foreseen of it", "mm", {{"motion", "motion/z_m", true}}, 1e3};
  for (const auto& name : names) {
    errors.series.push_back({name, name + "/error_m"});
    z.series.push_back({name, name + "/z_m"});
  }
  report.plots = {errors, z};
  report.tables = {table_of(summary)};
  report.table = &table;
  report.summary = summary;
  return report;
}

int run_predict(const PredictOptions& o) {
  if (o.run.list) {
    for (const auto& engine : servo::predictors().engines()) fmt::print("{:<24}{}\n", engine.name, engine.summary);
    return DONE;
  }
  if (o.run.source.empty()) throw ConfigError("MOTION.csv is missing: give a file with time_s and measured/x_m, ...");
  const auto names = chosen_predictors(o);
  const servo::MotionRecord record = servo::read_motion_record(o.run.source, o.points);
  const servo::ScoreOptions options = score_options(o, record);
  if (!o.run.quiet)
    for (const auto& warning : record.warnings) fmt::print(stderr, "heartservo: {}\n", warning);

  RunFolder folder(run_path(o.run, "predict"));
  const std::size_t shown = shown_horizon(options.horizons_s);
  const std::string reference = record.truth.empty() ? "measurement" : "truth";
  nlohmann::json summary{{"command", "predict"},
                         {"version", HEARTSERVO_VERSION},
                         {"source", o.run.source},
                         {"points", record.group},
                         {"reference", reference},
                         {"rows", record.time_s.size()},
                         {"period_s", record.period_s()},
                         {"settle_s", options.settle_s},
                         {"beats", options.r_peaks_s.size()},
                         {"predictors", nlohmann::json::array()}};
  std::vector<std::vector<double>> columns;  // z and error of each predictor
  std::vector<Eigen::Vector3d> truth(record.time_s.size());
  bool interrupted = false;
  {
    const Interrupt interrupt;
    Progress progress("predict " + stem_of(o.run.source), names.size() * record.time_s.size(), o.run.quiet);
    std::size_t done = 0;
    for (const auto& name : names) {
      if ((interrupted = interrupt.requested())) break;
      std::vector<double> z(record.time_s.size(), NAN), error = z;
      const auto predictor = servo::predictors().make(name, servo::PredictorOptions{});
      const auto watch = [&](std::size_t row, std::size_t h, const servo::Prediction& p, const Eigen::Vector3d& there) {
        if (h != shown) return;
        progress.update(++done);
        truth[row] = there;
        if (!p.valid) return;
        z[row] = p.position.z();
        error[row] = (p.position - there).norm();
      };
      summary["predictors"].push_back(summary_of(name, servo::score_predictor(record, options, *predictor, watch)));
      columns.push_back(std::move(z));
      columns.push_back(std::move(error));
    }
  }
  summary["interrupted"] = interrupted;
  if (columns.empty()) return INTERRUPTED;
  const std::vector<std::string> run(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(columns.size() / 2));
  std::vector<std::string> header{"time_s", "motion/x_m", "motion/y_m", "motion/z_m"};
  for (const auto& name : run) header.insert(header.end(), {name + "/z_m", name + "/error_m"});
  TimeTable table(header, record.time_s.size());
  for (std::size_t i = 0; i < record.time_s.size(); ++i) {
    std::vector<double> row{record.time_s[i] + options.horizons_s[shown], truth[i].x(), truth[i].y(), truth[i].z()};
    for (const auto& column : columns) row.push_back(column[i]);
    table.append(row);
  }
  table.write_csv(folder.file("frames.csv"));
  Report report = report_of(summary, run, options.horizons_s[shown], table);
  report.config_yaml = config_of(o, run, summary);
  finish_run(folder, report, o.run,
             fmt::format("{}: {} rows of {}, scored on the {} after {:.1f} s\n\n{}", o.run.source, record.time_s.size(),
                         record.group, reference, options.settle_s, terminal_text(table_of(summary), false)));
  return interrupted ? INTERRUPTED : DONE;
}

}  // namespace

Command add_predict_command(CLI::App& program) {
  auto options = std::make_shared<PredictOptions>();
  PredictOptions& o = *options;
  CLI::App* app = program.add_subcommand("predict", "predictors side by side on a motion record");
  app->add_option("motion", o.run.source, "CSV with time_s, measured/x_m, ... and optionally truth/x_m, ...")
      ->type_name("MOTION.csv");
  app->add_option("--predictor", o.predictors, "predictors, separated by commas, or 'all' (default)")->delimiter(',');
  app->add_option("--horizons-ms", o.horizons_ms, "how far ahead, separated by commas (default 8,16,32,64,128)")
      ->delimiter(',')
      ->check(finite(0.1, 5000));
  const CLI::Option* settle =
      app->add_option("--settle-s", o.settle_s, "not scored at the start (default 30, or a third of a short record)")
          ->check(finite(0, 1e6));
  app->add_option("--beats", o.beats, "CSV with time_s of R peaks, as from an ECG; each is known once it has happened")
      ->type_name("FILE");
  app->add_option("--points", o.points, "columns NAME/x_m, ... where the file has several")->type_name("NAME");
  app->add_option("--out", o.run.out, "run folder (default: runs/predict-NAME-DATE)")->type_name("DIR");
  app->add_flag("--json", o.run.json, "print summary.json on stdout and nothing else");
  app->add_flag("--quiet", o.run.quiet, "no progress and no table");
  app->add_flag("--list", o.run.list, "list the predictors and exit");
  app->footer(
      "Examples:\n  heartservo predict motion.csv --predictor hold,harmonic,mixture --horizons-ms 16,64\n"
      "  heartservo predict motion.csv --beats beats.csv --predictor harmonic_ecg,mixture\n"
      "  heartservo predict in_vivo.csv --points point3 --horizons-ms 40,80,160 --settle-s 5");
  return {app, [options, settle] {
            options->settle_given = settle->count() > 0;
            return run_predict(*options);
          }};
}

}  // namespace heartservo::tools
