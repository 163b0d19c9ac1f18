#include "tools/sweep/sweep_slurm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tools/command.hpp"
#include "tools/sweep/caught.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

constexpr const char* kNoSlurm =
    "there is no sbatch here: run this on a machine of the Slurm cluster (Debian: apt-get install slurm-client, with "
    "the "
    "cluster's slurm.conf and munge key), or sweep without --slurm";

// For sh.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

// What would break the sweep's own arrangement.
void require_sane(const std::string& options) {
  if (options.find_first_of("\n\r") != std::string::npos) throw ConfigError("--slurm: sbatch's options in one line");
  std::istringstream words(options);
  for (std::string word; words >> word;)
    for (const char* own : {"--array", "-a", "--dependency", "-d", "--wrap", "--chdir", "-D"})
      if (word == own || word.starts_with(own + std::string(own[1] == '-' ? "=" : "")))
        throw ConfigError(fmt::format("--slurm: {} is the sweep's own to say; the number of tasks is --tasks", own));
}

std::string call_of(const SweepPlan& plan, const fs::path& folder) {
  const fs::path program = fs::read_symlink("/proc/self/exe");
  return fmt::format("exec {} sweep {} \\\n  --out {}", quoted(program), quoted(fs::absolute(plan.file)),
                     quoted(folder));
}

std::string head_of(const SweepPlan& plan, const char* what, const char* script, const char* log) {
  std::string name = "sweep-" + stem_of(plan.file);
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c) && c != '-' && c != '_'; }, '_');
  return fmt::format(
      "#!/bin/sh\n# {} Written by heartservo {}.\n# By hand, in the sweep's folder: sbatch slurm/{}.sbatch\n"
      "#SBATCH --job-name={}-{}\n#SBATCH --output=slurm/{}.log\n#SBATCH --open-mode=append\n#SBATCH --requeue\n"
      "#SBATCH --ntasks=1\n",
      what, HEARTSERVO_VERSION, script, name, script, log);
}

std::string options_of(const SlurmRequest& request) {
  return request.options.empty() ? "" : fmt::format("#SBATCH {}\n", request.options);
}

json submission(const fs::path& folder) {
  std::ifstream in(folder / "slurm/submission.json");
  json j = json::parse(in, nullptr, false);
  return j.is_object() ? j : json::object();
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  out.close();
  if (!out) throw ConfigError(fmt::format("{}: cannot be written; check space and permissions", file.string()));
}

// The id that sbatch gives, without the cluster's name.
std::string sbatch(const fs::path& folder, std::vector<std::string> options, const char* script) {
  std::vector<std::string> command{"sbatch", "--parsable", "--chdir=" + folder.string()};
  command.insert(command.end(), options.begin(), options.end());
  command.push_back(folder / "slurm" / script);
  const Caught answer = ask_program(command);
  if (answer.code == 127) throw DeviceError(kNoSlurm);
  const std::string id = answer.out.substr(0, answer.out.find(';'));
  if (answer.code != 0 || id.empty() || id.find_first_not_of("0123456789") != std::string::npos)
    throw ConfigError(fmt::format("sbatch refuses {}: {}", (folder / "slurm" / script).string(),
                                  answer.err.empty() ? fmt::format("it says '{}'", answer.out) : answer.err));
  return id;
}

}  // namespace

int shares_for(std::uint64_t runs) { return static_cast<int>(std::clamp<std::uint64_t>((runs + 3) / 4, 1, 100)); }

std::string task_list(const std::vector<int>& tasks) {
  std::string text;
  for (std::size_t i = 0; i < tasks.size();) {
    std::size_t last = i;
    while (last + 1 < tasks.size() && tasks[last + 1] == tasks[last] + 1) ++last;
    text += text.empty() ? "" : ",";
    text += last == i ? std::to_string(tasks[i]) : fmt::format("{}-{}", tasks[i], tasks[last]);
    i = last + 1;
  }
  return text;
}

std::string array_script(const SweepPlan& plan, const fs::path& folder, const SlurmRequest& request, int shares,
                         const std::vector<int>& tasks) {
  return head_of(plan, "Task K does share K of the sweep's runs; what is done is not done again.", "share",
                 "share-%a") +
         fmt::format("#SBATCH --array={}\n#SBATCH --cpus-per-task={}\n", task_list(tasks), request.jobs) +
         options_of(request) +
         fmt::format(
             "{} \\\n  --share \"$SLURM_ARRAY_TASK_ID/{}\" --jobs \"${{SLURM_CPUS_PER_TASK:-1}}\" --wait --quiet{}{}\n",
             call_of(plan, folder), shares, request.retry ? " --retry" : "", plan.runs() > kManyRuns ? " --yes" : "");
}

std::string merge_script(const SweepPlan& plan, const fs::path& folder, const SlurmRequest& request) {
  return head_of(plan, "Puts together what the shares have done.", "merge", "merge") + options_of(request) +
         call_of(plan, folder) + fmt::format(" \\\n  --merge --wait{}\n", plan.runs() > kManyRuns ? " --yes" : "");
}

SlurmJobs submit(const SweepPlan& plan, const fs::path& folder, const std::vector<std::uint64_t>& left,
                 const SlurmRequest& request) {
  require_sane(request.options);
  const json before = submission(folder);
  if (before.contains("array")) {
    const std::string id = before["array"];
    if (const Caught queue = ask_program({"squeue", "--noheader", "--format=%i", "--jobs=" + id});
        queue.code == 0 && !queue.out.empty())
      throw ConfigError(
          fmt::format("{}: job {} is still at this sweep (squeue --jobs={}); wait for it, or end it by scancel {}",
                      folder.string(), id, id, id));
  }
  SlurmJobs jobs;
  jobs.shares = request.tasks > 0 ? request.tasks : before.value("shares", shares_for(plan.runs()));
  std::set<int> tasks;
  for (const std::uint64_t run : left)
    tasks.insert(static_cast<int>(run % static_cast<std::uint64_t>(jobs.shares)) + 1);
  jobs.submitted.assign(tasks.begin(), tasks.end());
  fs::create_directories(folder / "slurm");
  write(folder / "slurm/share.sbatch", array_script(plan, folder, request, jobs.shares, jobs.submitted));
  write(folder / "slurm/merge.sbatch", merge_script(plan, folder, request));
  jobs.array = sbatch(folder, {}, "share.sbatch");
  write(folder / "slurm/submission.json", json{{"array", jobs.array}, {"shares", jobs.shares}}.dump(2) + "\n");
  try {
    // after any end: what failed tasks have done is merged, too
    jobs.merge = sbatch(folder, {"--dependency=afterany:" + jobs.array}, "merge.sbatch");
  } catch (const ConfigError& e) {
    throw ConfigError(fmt::format("job {} is submitted, but not its merge; when it has ended, give --merge: {}",
                                  jobs.array, e.what()));
  }
  return jobs;
}

}  // namespace heartservo::tools
