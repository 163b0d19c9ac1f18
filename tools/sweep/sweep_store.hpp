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

class SweepStore {
 public:
  /// Opens or makes `folder`. `share`: 0 for the whole, else the number of the share. Throws ConfigError: another sweep
  /// is in it, another process is writing it, it cannot be written; InputError: a line of it cannot be read.
  SweepStore(const std::filesystem::path& folder, const SweepPlan& plan, int share);
  ~SweepStore();
  SweepStore(const SweepStore&) = delete;
  SweepStore& operator=(const SweepStore&) = delete;

  bool has(std::uint64_t run) const { return results_.contains(run); }
  /// Appends in one write; a crash leaves whole lines. Throws ConfigError when the disk is full.
  void add(const SweepResult& result);
  /// Forgets failed runs, so that they are run again.
  void forget_failed();
  /// Takes over the results of all shares. Returns how many shares' files there were.
  int merge();

  const std::map<std::uint64_t, SweepResult>& results() const { return results_; }
  const std::filesystem::path& folder() const { return folder_; }
  /// results.csv: the same in the order of the runs.
  void write_sorted() const;

 private:
  void read(const std::filesystem::path& file);
  std::string line_of(const SweepResult& result) const;
  std::string header() const;

  std::filesystem::path folder_, file_;
  SweepPlan plan_;
  std::map<std::uint64_t, SweepResult> results_;
  int descriptor_ = -1;
};

}  // namespace heartservo::tools
