// heartservo analyse: spectrum, lines, respiration, velocity and acceleration of a motion (the paper's section 4.3).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "tools/analyse_report.hpp"
#include "tools/command.hpp"
#include "tools/run_folder.hpp"
#include "tools/track_tables.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

struct AnalyseOptions {
  RunOptions run;
  servo::AnalysisOptions analysis;
  std::string points;
};

std::string config_of(const AnalyseOptions& o, const AnalysisRun& run) {
  const auto& m = run.measured;
  return fmt::format(
      "# heartservo {} analyse: the resolved configuration\nsource: {}\npoints: {}\nsegment_s: {}\nsplit_hz: {}\n"
      "cutoff_hz: [{}, {}, {}]\nleast_percent: {}\nedge_s: {}\n",
      HEARTSERVO_VERSION, nlohmann::json(std::filesystem::absolute(run.record.file).string()).dump(),
      nlohmann::json(run.record.group).dump(), o.analysis.segment_s, m.split_hz, m.axis[0].cutoff_hz,
      m.axis[1].cutoff_hz, m.axis[2].cutoff_hz, o.analysis.least_percent, o.analysis.edge_s);
}

int run_analyse(const AnalyseOptions& o) {
  if (o.run.source.empty())
    throw ConfigError(
        "MOTION is missing: give a CSV with time_s, measured/x_m, ..., or a run folder of track or servo");
  if (const auto problems = o.analysis.validate(); !problems.empty())
    throw ConfigError(fmt::format("{}", fmt::join(problems, "; ")));
  AnalysisRun run;
  run.source = o.run.source;
  run.options = o.analysis;
  run.record = servo::read_motion_record(o.run.source, o.points);
  run.measured = servo::analyse(run.record, run.record.measured, o.analysis);
  if (!run.record.truth.empty()) run.truth = servo::analyse(run.record, run.record.truth, o.analysis);

  const auto summary = analyse_summary(run);
  const TimeTable motion = motion_table(run), spectrum = spectrum_table(run);
  RunFolder folder(run_path(o.run, "analyse"));
  motion.write_csv(folder.file("motion.csv"));
  spectrum.write_csv(folder.file("spectrum.csv"));
  const auto report = analyse_report(run, summary, motion, spectrum, config_of(o, run));
  std::string text = fmt::format("{}\n", report.headline);
  for (const auto& table : report.tables) text += fmt::format("\n{}\n\n{}", table.title, terminal_text(table, true));
  for (const auto& note : report.notices) text += fmt::format("Note: {}\n", note);
  finish_run(folder, report, o.run, text);
  return DONE;
}

}  // namespace

Command add_analyse_command(CLI::App& program) {
  auto options = std::make_shared<AnalyseOptions>();
  AnalyseOptions& o = *options;
  CLI::App* app = program.add_subcommand("analyse", "spectrum, respiration and acceleration of a motion");
  app->add_option("motion", o.run.source,
                  "CSV with time_s, measured/x_m, ...; .tum trajectory; or the run folder of track or servo");
  app->add_option("--points", o.points, "which columns: NAME of NAME/x_m, NAME/y_m, NAME/z_m (default measured)")
      ->type_name("NAME");
  app->add_option("--segment-s", o.analysis.segment_s, "segments of the spectrum (default 20 s)")
      ->check(finite(2, 1e5));
  app->add_option("--split-hz", o.analysis.split_hz,
                  "respiration lies below (default 1 Hz, less where the heart is slower)")
      ->check(finite(0.05, 1000));
  app->add_option("--cutoff-hz", o.analysis.cutoff_hz,
                  "low-pass of velocity and acceleration (default: chosen per axis by signal and noise)")
      ->check(finite(0.5, 10000));
  app->add_option("--out", o.run.out, "run folder (default: runs/analyse-NAME-DATE)")->type_name("DIR");
  app->add_flag("--json", o.run.json, "print summary.json on stdout and nothing else");
  app->add_flag("--quiet", o.run.quiet, "no table");
  app->footer(
      "Examples:\n  heartservo analyse MOTION.csv\n"
      "  heartservo analyse runs/tracked --cutoff-hz 15 --json\n"
      "The run folder holds report.html, summary.json, motion.csv and spectrum.csv. docs/motion.md defines the "
      "numbers.");
  return {app, [options] { return run_analyse(*options); }};
}

}  // namespace heartservo::tools
