#pragma once
// What a sweep file asks for: a scene, changes for all runs, and axes whose product is the runs.
//
//   title: Predictors against latency
//   scene: ../pig_2007.yaml              # as seen from the sweep file
//   set: {duration_s: 20, settle_s: 8}   # keys of the scene by their paths, for every run
//   axes:                                # the first varies slowest
//     engines.predictor: [hold, mixture]
//     latency_ms: [8, 16, 32]            # the total; its parts keep their proportions
//     seed: {from: 1, to: 20}            # whole numbers; with steps: evenly spaced values
//   metrics: [residual.rms_mm, residual.max_mm]   # of summary.json; these and more by default
#include <cstdint>
#include <string>
#include <vector>

#include "sim/scene/scene.hpp"

namespace heartservo::tools {

constexpr std::uint64_t kManyRuns = 20000;  ///< more are asked for on purpose (--yes)

struct SweepAxis {
  std::string key;                  ///< "engines.predictor", "seed", "latency_ms"
  std::vector<std::string> values;  ///< as YAML
  bool numeric = false;             ///< all of them are numbers
};

struct SweepPlan {
  std::string file, title, scene;  ///< `scene`: resolved
  std::vector<std::pair<std::string, std::string>> set;
  std::vector<SweepAxis> axes;
  std::vector<std::string> metrics;

  /// Of the product; saturates at 2^62.
  std::uint64_t runs() const;
  /// The value of each axis in run `i`, from 0.
  std::vector<std::string> values(std::uint64_t i) const;
  /// The scene of run `i`. Throws ConfigError that names the sweep file and the key.
  sim::Scene scene_of(std::uint64_t i) const;
};

/// Throws InputError (file), ConfigError (keys, an axis without values, an unknown key of the scene).
SweepPlan read_sweep(const std::string& file);

}  // namespace heartservo::tools
