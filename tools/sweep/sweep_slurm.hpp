#pragma once
// A sweep on a Slurm cluster: a job array whose task K does share K of N, and a job after it that merges. What to run,
// when and where is the cluster's to decide; here are only two batch scripts, in FOLDER/slurm, and sbatch.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/sweep/sweep_plan.hpp"

namespace heartservo::tools {

struct SlurmRequest {
  std::string options;  ///< of sbatch, as typed: "--partition=long --time=2:00:00"
  int tasks = 0;        ///< shares; 0: as before, or by the number of runs
  int jobs = 1;         ///< runs at a time of a task, each on a core
  bool retry = false;   ///< failed runs, too
};

struct SlurmJobs {
  std::string array, merge;  ///< ids
  int shares = 0;
  std::vector<int> submitted;  ///< the shares among them in which something is left to do
};

/// How many shares for so many runs: four runs each, at most 100.
int shares_for(std::uint64_t runs);

/// "1-3,7" of {1, 2, 3, 7}.
std::string task_list(const std::vector<int>& tasks);

/// The batch scripts.
std::string array_script(const SweepPlan& plan, const std::filesystem::path& folder, const SlurmRequest& request,
                         int shares, const std::vector<int>& tasks);
std::string merge_script(const SweepPlan& plan, const std::filesystem::path& folder, const SlurmRequest& request);

/// Submits what is `left` to do. Throws ConfigError: a bad request, an earlier array that is still in the queue, sbatch
/// refuses; DeviceError: there is no sbatch.
SlurmJobs submit(const SweepPlan& plan, const std::filesystem::path& folder, const std::vector<std::uint64_t>& left,
                 const SlurmRequest& request);

}  // namespace heartservo::tools
