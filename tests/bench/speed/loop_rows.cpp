// The whole chain in the simulated loop, and several regions at once.
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <chrono>

#include "servo/loop/loop.hpp"
#include "sim/scene/scene.hpp"
#include "sim/table/stages.hpp"
#include "sim/table/table.hpp"
#include "tests/bench/speed/rows.hpp"
#include "tests/bench/speed/wave_sequence.hpp"

namespace heartservo::bench {

namespace {

double wall_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

struct ChainRun {
  std::vector<double> chain_s, track_s;
  double wall = 0, cpu = 0;
  int frames = 0;
};

// The loop on the shipped scene with a landmark.
ChainRun run_chain(const std::string& tracker, int frames) {
  sim::Scene scene = sim::load_scene(HEARTSERVO_SOURCE_DIR "/scenes/pig_2007.yaml");
  scene.engines.tracker = tracker;
  scene.duration_s = frames / 125.0;
  const auto table = sim::make_table(scene);
  const auto options = sim::loop_options(scene, *table);
  servo::Loop loop(table->frames(), table->robot(), sim::make_stages(scene, *table), options, table->marker_to_tip(),
                   thread_cpu_s);
  const auto picked = table->picked();
  ChainRun run;
  if (!loop.start(picked.target, picked.marker).empty()) return run;
  servo::LoopRecord record;
  const double begin_wall = wall_s(), begin_cpu = cpu_s();
  while (loop.step(record)) {
    if (++run.frames <= 10) continue;  // memory is new
    run.chain_s.push_back(1e-3 * record.chain_ms);
    run.track_s.push_back(1e-3 * record.track_ms);
  }
  run.wall = wall_s() - begin_wall, run.cpu = cpu_s() - begin_cpu;
  return run;
}

}  // namespace

void add_chain_rows(Results& results, int frames) {
  results.heading("chain track + pose + predict + control, target and tool marker; scenes/pig_2007.yaml");
  for (const auto& [tracker, goal] : {std::pair{"esm", 1.0}, {"composite", 3.0}, {"deformable", 2.5}}) {
    const ChainRun run = run_chain(tracker, frames);
    results.add(fmt::format("chain, {}: p99", tracker), 1e3 * quantile(run.chain_s, 0.99), "ms", goal, false,
                fmt::format("median {:.3f} ms, of it trackers {:.3f} ms, {} frames", 1e3 * quantile(run.chain_s, 0.5),
                            1e3 * quantile(run.track_s, 0.5), run.frames));
    if (std::string(tracker) != "esm") continue;
    const double simulated = run.frames / 125.0;
    results.add("simulated loop, rendering included, two cores", simulated / (run.cpu / 2), "x", 3, true,
                fmt::format("times real time at 125 Hz if both cores were free: {:.2f} ms CPU a frame; {:.2f} x by the wall "
                            "clock here",
                            1e3 * run.cpu / run.frames, simulated / run.wall));
  }
}

void add_parallel_rows(Results& results) {
  results.heading("four regions at once, deformable 80 x 80");
  const auto& frames = wave_sequence().frames;
  // The best of some rounds: other programs on the machine cost some rounds more.
  const auto rate = [&](std::size_t cores) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, cores);
    std::vector<std::unique_ptr<tracking::TargetTracker>> trackers;
    for (int i = 0; i < 4; ++i) {
      trackers.push_back(tracking::trackers().make("deformable", tracking::Camera{}, {}));
      trackers.back()->start(frames[0], tracking::rectangle(150 + 120 * (i % 2), 150 + 120 * (i / 2), 80, 80));
    }
    double best = HUGE_VAL;
    for (std::size_t k = 1; k < frames.size(); ++k) {
      tracking::Frame frame = frames[k];
      frame.time_s = 0.008 * static_cast<double>(k);
      const double begin = wall_s();
      tbb::parallel_for(0, 4, [&](int i) { trackers[static_cast<std::size_t>(i)]->track(frame); });
      if (k > 10) best = std::min(best, wall_s() - begin);
    }
    return best;
  };
  const double one = rate(1), two = rate(2);
  results.add("throughput of two cores over one", one / two, "x", 1.8, true,
              fmt::format("wall clock, quickest frame: {:.3f} and {:.3f} ms", 1e3 * one, 1e3 * two));
}

}  // namespace heartservo::bench
