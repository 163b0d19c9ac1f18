// esm on the artificial sequences, and beside ViSP's trackers.
#include <cmath>
#include <map>
#include <memory>

#include "sim/sequence/artificial_sequence.hpp"
#include "tests/bench/speed/rows.hpp"
#include "tests/bench/speed/wave_sequence.hpp"

namespace heartservo::bench {

namespace {

// Operations for one point in one pass: the 21 sums of plain ESM with moments of x row by row (the comparison's count);
// gain, bias and weights are not in it.
constexpr double kFlops = 92;
constexpr double kWords = 2;  // of 8-bit pixels: two rows of a bilinear sample

struct Runs {
  std::vector<double> seconds, errors_px, passes;
  int lost = 0;
};

// Two textures at three places.
Runs run(const std::string& tracker_name, const std::string& name, int side) {
  static std::map<std::string, std::shared_ptr<const sim::BasePicture>> bases;
  static std::map<std::string, std::vector<tracking::Frame>> known;
  Runs runs;
  for (const char* texture : {"detail", "retina"})
    for (const int place : {0, 1, 2}) {
      sim::SequenceOptions options = sim::SequenceOptions::named(name);
      options.texture = texture, options.place = place, options.side_px = side;
      auto& base = bases[texture];
      if (!base) base = sim::base_picture_of(options);
      sim::ArtificialSequence sequence(options, base);
      auto& frames = known[fmt::format("{} {} {}", name, texture, place)];
      if (frames.empty())
        for (tracking::Frame frame; sequence.next(frame);) frames.push_back(frame);
      const auto tracker = tracking::trackers().make(tracker_name, tracking::Camera{}, {});
      tracker->start(frames[0], sequence.region());
      for (std::size_t k = 1; k < frames.size(); ++k) {
        const double begin = cpu_s();
        const tracking::Track track = tracker->track(frames[k]);
        runs.seconds.push_back(cpu_s() - begin);
        runs.passes.push_back(track.iterations);
        if (track.state == tracking::TrackState::LOST) {
          ++runs.lost;
          continue;
        }
        double error = 0;
        const auto truth = sequence.corners(k);
        for (std::size_t i = 0; i < 4; ++i) error += (track.corners[i] - truth[i]).norm() / 4;
        runs.errors_px.push_back(error);
      }
    }
  return runs;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? NAN : sum / static_cast<double>(values.size());
}

}  // namespace

void add_esm_rows(Results& results, const MachineLimit& machine) {
  results.heading("esm, gain and bias and robust weights on; sequences of 2 textures x 3 places, 151 frames");
  // The comparison's machine reached 111 GFLOP/s; its probe of plain ESM took 0.043 / 0.125 / 0.258 ms there.
  const double slower = 111 / machine.gflops;
  const double per_pass_ns = kFlops / machine.gflops + kWords * machine.word_ns();
  results.add("limit: one point in one pass", per_pass_ns, "ns", NAN, false, "92 operations and 2 words of pixels");
  for (const auto& [side, goal] : {std::pair{40, 0.05}, {80, 0.13}, {120, 0.27}}) {
    const Runs runs = run("esm", "b", side);
    const double ms = 1e3 * quantile(runs.seconds, 0.5), passes = mean(runs.passes), points = side * side;
    results.add(fmt::format("esm b {0} x {0}", side), ms, "ms", goal * slower, false,
                fmt::format("median; error {:.4f} px, {:.1f} passes, p99 {:.3f} ms, lost {}", mean(runs.errors_px),
                            passes, 1e3 * quantile(runs.seconds, 0.99), runs.lost));
    results.add(fmt::format("esm b {0} x {0}, times the limit of its passes", side),
                1e6 * ms / (passes * points * per_pass_ns), "x", 2.5, false,
                fmt::format("{:.2f} ns a point and pass", 1e6 * ms / (passes * points)));
  }
  for (const char* name : {"d", "c"})
    for (const int side : {40, 80, 120}) {
      const Runs runs = run("esm", name, side);
      results.add(fmt::format("esm {0} {1} x {1}", name, side), 1e3 * quantile(runs.seconds, 0.5), "ms", 0.5, false,
                  fmt::format("median; error {:.4f} px, p99 {:.3f} ms, lost {}", mean(runs.errors_px),
                              1e3 * quantile(runs.seconds, 0.99), runs.lost));
    }
}

void add_peer_rows(Results& results) {
  results.heading("esm beside ViSP's trackers, 80 x 80, frames of strong smooth texture on which all reach 0.02 px");
  double esm_s = 0;
  for (const auto& [name, goal] : {std::pair{"esm", 0.0}, {"visp_esm", 100.0}, {"visp_ic", 16.0}}) {
    Walk walk(name, 80);
    for (int k = 0; k < 2 * kFrames - 2; ++k) walk.step();
    const double s = quantile(walk.seconds, 0.5);
    const std::string note = fmt::format("{:.3f} ms, error {:.4f} px, lost {}", 1e3 * s, walk.mean_error_px(), walk.lost);
    if (esm_s == 0)
      esm_s = s, results.add("esm", 1e3 * s, "ms", NAN, false, note);
    else
      results.add(fmt::format("{} over esm", name), s / esm_s, "x", goal, true, note);
    results.add(fmt::format("{}: error", name), walk.mean_error_px(), "px", 0.02);
  }
}

}  // namespace heartservo::bench
