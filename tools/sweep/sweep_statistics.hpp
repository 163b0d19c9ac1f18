#pragma once
// Medians with confidence over the seeds, and pairs of settings compared on the same seeds.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "tools/sweep/sweep_store.hpp"

namespace heartservo::tools {

struct Interval {
  double median = 0, low = 0, high = 0;  ///< 95 %, by the bootstrap's percentiles
  std::size_t count = 0;
};

/// 2000 resamples drawn from `seed`; NaN values are left out. All zero for none.
Interval median_interval(std::vector<double> values, std::uint64_t seed = 1);

/// The results grouped by every axis but `seed`: {"groups": [{"values": {axis: value}, "runs": n, "done", "stopped",
/// "failed", "metrics": {name: {"median", "low", "high"}}}], "pairs": [{"axis", "a", "b", "others", "metric": the first
/// metric, "seeds": n, "median_difference", "low", "high", "a_is_less": share of the seeds}]}. Pairs: of neighbouring
/// values of each axis whose values are names, everything else equal.
nlohmann::json sweep_statistics(const SweepPlan& plan, const std::map<std::uint64_t, SweepResult>& results);

}  // namespace heartservo::tools
