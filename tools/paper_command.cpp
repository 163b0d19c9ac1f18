// heartservo paper: every experiment of the paper, beside its printed values.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "tools/command.hpp"
#include "tools/paper/paper_report.hpp"
#include "tools/program.hpp"
#include "tools/report/report.hpp"
#include "tools/run_folder.hpp"
#include "tools/shipped.hpp"
#include "tools/track_tables.hpp"

namespace heartservo::tools {

namespace {

namespace fs = std::filesystem;

struct PaperOptions {
  RunOptions run;
  std::string data;
  bool short_run = false;
};

// One experiment: the program itself, with its own page, in a folder of the whole.
int carry_out(std::vector<std::string> arguments, const fs::path& out) {
  for (auto& argument : arguments) argument = shipped(argument);
  arguments.insert(arguments.end(), {"--quiet", "--out", out.string()});
  return run_program(arguments);
}

int run_paper(const PaperOptions& o) {
  const auto experiments = paper_experiments(o.data, o.run.seed.value_or(-1), o.short_run);
  RunFolder folder(run_path(o.run, "paper"));
  std::size_t step = 0;
  const auto begin = std::chrono::steady_clock::now();
  const auto say = [&](const std::string& what) {
    const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!o.run.quiet) fmt::print(stderr, "[{}/{}] {:4.0f} s  {}\n", ++step, experiments.size() + 1, s, what);
  };
  for (const auto& experiment : experiments) {
    say(experiment.title);
    if (const int code = carry_out(experiment.arguments, folder.file(experiment.name)); code != DONE) return code;
    if (experiment.name != "sequence") continue;
    for (const char* landmark : {"1", "2"}) {
      const fs::path csv = folder.file(experiment.name) / fmt::format("frames_region{}.csv", landmark);
      const int code = carry_out({"analyse", csv.string()}, folder.file(fmt::format("motion{}", landmark)));
      if (code != DONE) return code;
    }
  }
  say("the page");
  PaperPage page;
  fill_paper_page(folder.file(""), experiments, page);
  Report& report = page.report;
  report.table = &page.tables.front();
  report.summary["command"] = "paper";
  report.summary["version"] = HEARTSERVO_VERSION;
  report.summary["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (const auto& table : report.tables)
    report.summary["tables"].push_back({{"title", table.title}, {"header", table.header}, {"rows", table.rows}});
  report.config_yaml = fmt::format("# heartservo {} paper\n", HEARTSERVO_VERSION);
  for (const auto& e : experiments)
    report.config_yaml += fmt::format("{}: {}\n", e.name, nlohmann::json(command_line(e)).dump());
  if (o.data.empty())
    report.notices.emplace_back("Fig. 8 on a recorded heart was left out: give --data with the folder of recordings.");
  std::string text;
  for (const auto& table : report.tables) text += fmt::format("{}\n\n{}\n", table.title, terminal_text(table, true));
  write_report(report, folder.file("paper.html"));
  finish_run(folder, report, o.run, text);
  return DONE;
}

}  // namespace

Command add_paper_command(CLI::App& program) {
  auto options = std::make_shared<PaperOptions>();
  PaperOptions& o = *options;
  CLI::App* app = program.add_subcommand("paper", "every table and figure of the paper, beside its printed values");
  app->add_option("--out", o.run.out, "folder (default: runs/paper-DATE)")->type_name("DIR");
  app->add_option("--data", o.data, "folder of recorded data, which has heart_invivo/left")
      ->type_name("DIR")
      ->check(CLI::ExistingDirectory);
  app->add_option("--seed", o.run.seed, "seed of every random draw")->check(CLI::Range(0, 2000000000));
  app->add_flag("--short", o.short_run, "a few frames of each, to see that all work; the numbers mean little");
  app->add_flag("--json", o.run.json, "print summary.json on stdout and nothing else");
  app->add_flag("--quiet", o.run.quiet, "no progress and no tables");
  app->footer(
      "Examples:\n  heartservo paper\n  heartservo paper --data recordings --out reproduced\n"
      "The folder holds paper.html, and a run folder for each experiment.");
  return {app, [options] { return run_paper(*options); }};
}

}  // namespace heartservo::tools
