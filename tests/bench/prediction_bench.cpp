// One observe and one predict, three axes, 8 harmonics, of each predictor after 20 s: mean time, and the 99th
// percentile of single steps as a counter (us). 125 Hz, the reference motion.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <vector>

#include "servo/prediction/registry.hpp"
#include "tests/support/reference_motion.hpp"

namespace {

using namespace heartservo;

// CPU time of this thread: another process's turn is not the predictor's.
double cpu_us() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

void observe_predict(benchmark::State& state, const std::string& name) {
  static const servo::MotionRecord record = test::recorded(test::drawn({}, 110, 1), 110, 1);
  servo::PredictorOptions options;
  options.harmonics = 8;
  std::vector<double> times;
  for (auto _ : state) {
    const auto predictor = servo::predictors().make(name, options);
    for (std::size_t i = 0; i < record.time_s.size(); ++i) {
      const double begin = cpu_us();
      predictor->observe({record.time_s[i], record.measured[i], Eigen::Matrix3d::Zero()});
      benchmark::DoNotOptimize(predictor->predict(record.time_s[i] + 0.033));
      times.push_back(cpu_us() - begin);
    }
  }
  std::sort(times.begin(), times.end());
  state.counters["p50_us"] = times[times.size() / 2];
  state.counters["p99_us"] = times[times.size() * 99 / 100];
  state.counters["max_us"] = times.back();
}

const bool registered = [] {
  for (const auto& name : servo::predictors().names())
    benchmark::RegisterBenchmark(("predict/" + name).c_str(), [name](benchmark::State& state) {
      observe_predict(state, name);
    })->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
