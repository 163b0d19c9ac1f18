// heartservo report: one page of one run, of several side by side, or of a sweep.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "tools/command.hpp"
#include "tools/loop_table.hpp"
#include "tools/report/report.hpp"
#include "tools/report/stored_pictures.hpp"
#include "tools/run_comparison.hpp"
#include "tools/servo_report.hpp"
#include "tools/sweep/sweep_report.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

namespace fs = std::filesystem;

struct ReportOptions {
  std::vector<std::string> runs;
  std::string out = "report.html";
  bool quiet = false;
};

void write_page(const ReportOptions& o, const Report& report) {
  write_report(report, o.out);
  if (!o.quiet) fmt::print("{}\nreport: {}\n", report.headline, fs::absolute(o.out).string());
}

void one_run(const ReportOptions& o, const StoredRun& run) {
  if (run.command() == "servo" && run.frames) {
    const TimeTable table = with_motion(*run.frames), spectrum = servo_spectrum(table, run.summary);
    Report report = servo_report(run.summary, table, spectrum, read_pictures(run.folder), run.config_yaml);
    if (std::error_code error; fs::exists(run.folder / "video.webm", error))
      report.video = {"The endoscope's picture, and the view in which the region stands still.",
                      run.folder / "video.webm"};
    write_page(o, report);
    return;
  }
  const std::vector<StoredRun> runs{run};
  const TimeTable table = together(runs, compared_columns(runs));
  Report report = comparison_report(runs, table);
  report.title = fmt::format("{} {}", run.command(), run.name);
  report.headline = run.frames ? fmt::format("{} frames.", run.frames->rows()) : "A run without frames.";
  report.headline_number.clear();
  report.notices.clear();
  report.pictures = read_pictures(run.folder);
  report.tables = {summary_table(runs, false)};
  report.config_yaml = run.config_yaml;
  report.summary = run.summary;
  write_page(o, report);
}

int write_report_of(const ReportOptions& o, const std::vector<StoredRun>& runs) {
  for (const auto& run : runs)
    if (run.command() != runs.front().command())
      throw ConfigError(fmt::format("{} is a run of {}, but {} one of {}: they have nothing to compare",
                                    runs.front().folder.string(), runs.front().command(), run.folder.string(),
                                    run.command()));
  if (runs.size() == 1) {
    one_run(o, runs.front());
    return DONE;
  }
  const TimeTable table = together(runs, compared_columns(runs));
  write_page(o, comparison_report(runs, table));
  return DONE;
}

int run_report(const ReportOptions& o) {
  for (const auto& folder : o.runs) {
    if (!is_sweep(folder)) continue;
    if (o.runs.size() > 1) throw ConfigError(folder + " is a sweep, which has a page of its own: give it alone");
    const StoredSweep sweep = read_swept(folder);
    write_page(o, sweep_report(sweep.plan, sweep.results, sweep_summary(sweep.plan, sweep.results)));
    return DONE;
  }
  std::vector<StoredRun> runs;
  for (const auto& folder : o.runs) runs.push_back(read_run(folder));
  const auto foreign = [&](const std::exception& e) {
    return InputError(fmt::format("{}: frames.csv or summary.json is not as this version writes it ({}); run it again",
                                  fmt::join(o.runs, ", "), e.what()));
  };
  try {
    return write_report_of(o, runs);
  } catch (const nlohmann::json::exception& e) {  // a key that is missing
    throw foreign(e);
  } catch (const std::logic_error& e) {  // a column that is missing
    throw foreign(e);
  }
}

}  // namespace

Command add_report_command(CLI::App& program) {
  auto options = std::make_shared<ReportOptions>();
  ReportOptions& o = *options;
  CLI::App* app = program.add_subcommand("report", "one page of one run, of several side by side, or of a sweep");
  app->add_option("run", o.runs, "run folders, or the folder of a sweep")->required();
  app->add_option("--out", o.out, "the page (default report.html)")->type_name("FILE");
  app->add_flag("--quiet", o.quiet, "say nothing");
  app->footer(
      "Examples:\n  heartservo report RUN --out page.html\n"
      "  heartservo report RUN ANOTHER_RUN --out both.html");
  return {app, [options] { return run_report(*options); }};
}

}  // namespace heartservo::tools
