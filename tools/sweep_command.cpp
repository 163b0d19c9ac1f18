// heartservo sweep: the product of some settings, run on all cores, with statistics over the seeds.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <fstream>
#include <thread>

#include "tools/command.hpp"
#include "tools/interrupt.hpp"
#include "tools/progress.hpp"
#include "tools/run_folder.hpp"
#include "tools/servo_summary.hpp"
#include "tools/sweep/sweep_pool.hpp"
#include "tools/sweep/sweep_report.hpp"
#include "tools/sweep/sweep_slurm.hpp"
#include "tools/track_tables.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;

struct SweepOptions {
  std::string file, out, share, slurm;  // slurm: sbatch's options, kNoOptions for none
  int jobs = 0, tasks = 0;
  bool yes = false, merge = false, retry = false, wait = false, count = false, json = false, quiet = false;
};

constexpr const char* kNoOptions = "true";  // what CLI11 gives for a flag without a value

// "3/8": the third of eight.
std::pair<int, int> share_of(const std::string& text) {
  int number = 0, of = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d/%d%c", &number, &of, &rest) != 2 || number < 1 || of < number || of > 100000)
    throw ConfigError(fmt::format("--share '{}' must be NUMBER/OF, such as 3/8", text));
  return {number, of};
}

// results.csv, results.json, report.html of what there is.
int conclude(const SweepOptions& o, const SweepPlan& plan, const SweepStore& store) {
  store.write_sorted();
  const json summary = sweep_summary(plan, store.results());
  const Report report = sweep_report(plan, store.results(), summary);
  std::ofstream(store.folder() / "results.json") << summary.dump(2) << "\n";
  write_report(report, store.folder() / "report.html");
  if (o.json) {
    fmt::print("{}\n", summary.dump(2));
  } else if (!o.quiet) {
    fmt::print("{}\n\n", report.headline);
    for (const auto& table : report.tables) fmt::print("{}\n\n{}\n", table.title, terminal_text(table, true));
    fmt::print("report: {}\n", (store.folder() / "report.html").string());
  }
  return DONE;
}

// How the sweep's command begins, for hints.
std::string command_of(const SweepOptions& o) {
  const auto word = [](const std::string& text) {
    return text.find_first_of(" \t'\"$\\") == std::string::npos ? text : fmt::format("\"{}\"", text);
  };
  return fmt::format("heartservo sweep {}{}", word(o.file), o.out.empty() ? "" : " --out " + word(o.out));
}

// Hands what is left to do to the cluster.
int to_slurm(const SweepOptions& o, const SweepPlan& plan, const SweepStore& store) {
  std::vector<std::uint64_t> left;
  for (std::uint64_t i = 0; i < plan.runs(); ++i)
    if (!store.has(i)) left.push_back(i);
  if (left.empty()) return conclude(o, plan, store);
  SlurmRequest request;
  if (o.slurm != kNoOptions) request.options = o.slurm;
  request.tasks = o.tasks;
  request.jobs = std::max(1, o.jobs);
  request.retry = o.retry;
  const SlurmJobs jobs = submit(plan, store.folder(), left, request);
  const std::string folder = store.folder().string();
  if (o.json) {
    fmt::print("{}\n", json{{"command", "sweep"},
                            {"array_job", jobs.array},
                            {"merge_job", jobs.merge},
                            {"shares", jobs.shares},
                            {"tasks", jobs.submitted},
                            {"runs_left", left.size()},
                            {"folder", folder}}
                           .dump(2));
  } else if (!o.quiet) {
    fmt::print("job {}: {} of {} runs are left, in {} task{} (shares {} of {})\njob {}: merges when they have ended\n",
               jobs.array, left.size(), plan.runs(), jobs.submitted.size(), jobs.submitted.size() == 1 ? "" : "s",
               task_list(jobs.submitted), jobs.shares, jobs.merge);
    fmt::print("watch:    squeue --jobs={},{}\nscripts and logs: {}/slurm\nresults:  {}/results.csv, report.html\n",
               jobs.array, jobs.merge, folder, folder);
    fmt::print("again:    {} --slurm --retry submits what is missing then, and what failed\n", command_of(o));
  }
  return DONE;
}

int run_sweep(const SweepOptions& o) {
  const SweepPlan plan = read_sweep(o.file);
  const std::uint64_t all = plan.runs();
  if (o.count) {
    fmt::print("{}\n", all);
    return DONE;
  }
  if (all > kManyRuns && !o.yes)
    throw ConfigError(fmt::format("{}: {} runs; say --yes when that is what you want", plan.file, all));
  const auto [share, shares] = o.share.empty() ? std::pair(0, 1) : share_of(o.share);
  const std::filesystem::path folder =
      std::filesystem::absolute(o.out.empty() ? "runs/sweep-" + stem_of(plan.file) : o.out);
  SweepStore store(folder, plan, share, o.wait);
  if (o.merge || !o.slurm.empty()) store.merge();
  if (o.retry) store.forget_failed();
  if (!o.slurm.empty()) return to_slurm(o, plan, store);
  std::map<std::uint64_t, SweepResult> others;  // with another number of shares, their runs are others
  if (share > 0) others = store.elsewhere();
  if (o.retry) std::erase_if(others, [](const auto& r) { return r.second.status == "failed"; });
  std::vector<std::uint64_t> missing;
  if (!o.merge)
    for (std::uint64_t i = share > 0 ? static_cast<std::uint64_t>(share - 1) : 0; i < all;
         i += static_cast<std::uint64_t>(shares))
      if (!store.has(i) && !others.contains(i)) missing.push_back(i);
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  bool interrupted = false;
  {
    const Interrupt interrupt;
    Progress progress("sweep " + stem_of(plan.file), missing.size(), o.quiet || o.json);
    std::size_t count = 0;
    run_pool(
        plan, missing, o.jobs > 0 ? o.jobs : cores,
        [&](const SweepResult& result) {
          store.add(result);
          progress.update(++count);
        },
        [&] { return !(interrupted = interrupt.requested()); });
  }
  if (share > 0) {
    if (!o.quiet) fmt::print("share {}/{}: {} results in {}\n", share, shares, store.results().size(), folder.string());
    return interrupted ? INTERRUPTED : DONE;
  }
  const int code = conclude(o, plan, store);
  return interrupted ? INTERRUPTED : code;
}

}  // namespace

Command add_sweep_command(CLI::App& program) {
  auto options = std::make_shared<SweepOptions>();
  SweepOptions& o = *options;
  CLI::App* app = program.add_subcommand("sweep", "many runs: the product of settings and seeds, with statistics");
  app->add_option("sweep", o.file, "sweep file (.yaml)")->required();
  app->add_option("--out", o.out, "folder; what is in it is not run again (default: runs/sweep-NAME)")
      ->type_name("DIR");
  app->add_option("--jobs", o.jobs, "runs at a time (default: one a core; with --slurm, of each task: 1)")
      ->check(CLI::Range(1, 4096));
  auto* share =
      app->add_option("--share", o.share, "carry out only the NUMBER-th of OF equal shares, into a file of its own")
          ->type_name("NUMBER/OF");
  auto* merge = app->add_flag("--merge", o.merge, "take over what shares have done, run nothing");
  app->add_flag("--wait", o.wait, "when another heartservo is writing there, wait until it has ended");
  auto* slurm = app->add_flag("--slurm", o.slurm,
                              "submit a job array to the Slurm cluster that is there; --slurm='OPTIONS' are sbatch's")
                    ->type_name("[=OPTIONS]")
                    ->excludes(merge)
                    ->excludes(share);
  app->add_option("--tasks", o.tasks, "with --slurm: tasks of the array (default: four runs a task, at most 100)")
      ->check(CLI::Range(1, 100000))
      ->needs(slurm);
  app->add_flag("--retry", o.retry, "repeat the runs that failed");
  app->add_flag("--count", o.count, "print how many runs there are, and end");
  app->add_flag("--yes", o.yes, "yes, more than 20000 runs");
  app->add_flag("--json", o.json, "print results.json on stdout and nothing else");
  app->add_flag("--quiet", o.quiet, "no progress and no table");
  app->footer(
      "Examples:\n  heartservo sweep scenes/sweeps/latency.yaml\n"
      "  heartservo sweep scenes/sweeps/latency.yaml --share 1/4 --out swept\n"
      "  heartservo sweep scenes/sweeps/latency.yaml --slurm='--partition=long --time=2:00:00'\n"
      "The folder holds results.csv, results.json and report.html. An interrupted sweep goes on when it is run again.");
  return {app, [options] { return run_sweep(*options); }};
}

}  // namespace heartservo::tools
