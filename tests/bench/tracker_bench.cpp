// Every tracker of the registry on the same frames, templates of 40, 80 and 120 px: CPU time per frame, mean corner error
// and lost frames as counters, and how many times esm's time it takes (`times_esm`; at visp_esm: the gain over ViSP).
#include <benchmark/benchmark.h>

#include <map>

#include "tests/bench/speed/wave_sequence.hpp"

namespace {

using namespace heartservo;
using bench::kFrames;
using bench::Walk;

double esm_seconds(int side) {
  static std::map<int, double> known;
  if (!known.count(side)) {
    Walk walk("esm", side);
    for (int k = 0; k < kFrames; ++k) walk.step();
    known[side] = walk.mean_s();
  }
  return known[side];
}

void tracker(benchmark::State& state, const std::string& name) {
  const double esm = esm_seconds(static_cast<int>(state.range(0)));
  Walk walk(name, static_cast<double>(state.range(0)));
  for (auto _ : state) walk.step();
  state.counters["error_px"] = walk.mean_error_px();
  state.counters["lost"] = walk.lost;
  state.counters["times_esm"] = walk.mean_s() / esm;
}

const bool registered = [] {
  for (const auto& name : tracking::trackers().names())
    for (const int side : {40, 80, 120})
      benchmark::RegisterBenchmark(("tracker/" + name).c_str(), tracker, name)
          ->Arg(side)
          ->Iterations(2 * kFrames - 2)
          ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
