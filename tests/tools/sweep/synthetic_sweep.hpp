#pragma once
// The results of a sweep that nobody ran: four predictors at four latencies, five seeds; one run failed.
#include <cmath>

#include "tools/sweep/sweep_report.hpp"

namespace heartservo::test {

inline tools::StoredSweep synthetic_sweep() {
  tools::StoredSweep s;
  s.plan.file = "latency.yaml";
  s.plan.title = "Predictors <against> latency";
  s.plan.axes = {{"engines.predictor", {"hold", "constant_velocity", "autoregressive", "mixture"}, false},
                 {"latency_ms", {"8", "16", "32", "64"}, true},
                 {"seed", {"1", "2", "3", "4", "5"}, true}};
  s.plan.metrics = {"residual.rms_mm", "tracking.lost_frames", "timing.chain_ms.p50"};
  for (std::uint64_t i = 0; i < s.plan.runs(); ++i) {
    const auto predictor = static_cast<double>(i / 20), latency = std::stod(s.plan.values(i)[1]);
    const double seed = static_cast<double>(i % 5) + 1;
    s.results[i] = {
        i, "done", {latency / (10 + 20 * predictor) * (1 + 0.05 * seed), 0, 1 + predictor + 0.01 * seed}, 1, ""};
  }
  s.results[7] = {7, "failed", {NAN, NAN, NAN}, 1, "killed by signal 11"};
  return s;
}

}  // namespace heartservo::test
