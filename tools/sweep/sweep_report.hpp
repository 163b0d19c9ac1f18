#pragma once
// A sweep on a page and in a terminal: charts and tables from its results.
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tools/report/report.hpp"
#include "tools/sweep/sweep_store.hpp"

namespace heartservo::tools {

using SweepResults = std::map<std::uint64_t, SweepResult>;

/// A swept folder as it lies on disk. Of the plan only what results need: no scene, no settings.
struct StoredSweep {
  SweepPlan plan;
  SweepResults results;
};

/// True when the folder holds a sweep.
bool is_sweep(const std::filesystem::path& folder);

/// Throws InputError: no results.json, or one that is not a sweep's; ConfigError: results.csv does not belong to it.
StoredSweep read_swept(const std::filesystem::path& folder);

/// results.json.
nlohmann::json sweep_summary(const SweepPlan& plan, const SweepResults& results);

/// `summary`: sweep_summary().
Report sweep_report(const SweepPlan& plan, const SweepResults& results, const nlohmann::json& summary);

}  // namespace heartservo::tools
