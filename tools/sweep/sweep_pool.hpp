#pragma once
// Runs of a sweep, each in a process of its own: a run that crashes is recorded as failed and takes nothing with it.
#include <cstdint>
#include <functional>
#include <vector>

#include "tools/sweep/sweep_store.hpp"

namespace heartservo::tools {

/// Carries out `runs` with at most `jobs` at a time, each on one core, and hands every result to `done` in this
/// process, in the order in which they end. Stops taking new ones when `goes_on` says false, and then ends those that
/// run. Call it while this process has no other threads.
void run_pool(const SweepPlan& plan, const std::vector<std::uint64_t>& runs, int jobs,
              const std::function<void(const SweepResult&)>& done, const std::function<bool()>& goes_on);

}  // namespace heartservo::tools
