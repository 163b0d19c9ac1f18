#pragma once
// The results of a sweep on disk: runs.csv (or runs-K.csv of one share), a line a run, appended whole as soon as it has
// ended: run, the value of each axis, status, the metrics, seconds, error. What is there is not run again.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/sweep/sweep_plan.hpp"

namespace heartservo::tools {

struct SweepResult {
  std::uint64_t run = 0;
  std::string status;           ///< "done", "stopped" (by the guard), "failed"
  std::vector<double> metrics;  ///< as the plan has them; NaN where the summary has none
  double seconds = 0;
  std::string error;  ///< of a failed run, and why the guard stopped
};

/// The results in a file of a sweep, the last of each run; a line that is not whole is left out. Throws ConfigError
/// when it belongs to another sweep.
std::map<std::uint64_t, SweepResult> read_results(const std::filesystem::path& file, const SweepPlan& plan);

class SweepStore {
 public:
  /// Opens or makes `folder`. `share`: 0 for the whole, else the number of the share. Throws ConfigError: another sweep
  /// is in it, another process is writing it (unless `wait`: then waits until that one has ended), it cannot be
  /// written.
  SweepStore(const std::filesystem::path& folder, const SweepPlan& plan, int share, bool wait = false);
  ~SweepStore();
  SweepStore(const SweepStore&) = delete;
  SweepStore& operator=(const SweepStore&) = delete;

  bool has(std::uint64_t run) const { return results_.contains(run); }
  /// Appends in one write; a crash leaves whole lines. Throws ConfigError when the disk is full.
  void add(const SweepResult& result);
  /// Forgets failed runs, so that they are run again.
  void forget_failed();
  /// Takes over the results of all shares: of runs that are missing here or failed here but not there.
  void merge();
  /// The results in the folder's other files, as they are at this moment; others may be writing them.
  std::map<std::uint64_t, SweepResult> elsewhere() const;

  const std::map<std::uint64_t, SweepResult>& results() const { return results_; }
  const std::filesystem::path& folder() const { return folder_; }
  /// results.csv: the same in the order of the runs.
  void write_sorted() const;

 private:
  std::string line_of(const SweepResult& result) const;

  std::filesystem::path folder_, file_;
  SweepPlan plan_;
  std::map<std::uint64_t, SweepResult> results_;
  int descriptor_ = -1;
};

}  // namespace heartservo::tools
