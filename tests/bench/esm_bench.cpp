// ESM on a picture that moves a little from frame to frame: time per frame for templates of 40, 80 and 120 px.
#include <benchmark/benchmark.h>

#include <Eigen/LU>

#include "tests/support/analytic_image.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/planar/registry.hpp"

namespace {

using namespace heartservo;

void esm(benchmark::State& state) {
  const auto side = static_cast<double>(state.range(0));
  std::vector<tracking::Frame> frames(64);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const double t = 2 * M_PI * static_cast<double>(k) / static_cast<double>(frames.size());
    Eigen::Matrix3d H = Eigen::Matrix3d::Identity();
    H(0, 2) = 15 * std::sin(t);
    H(1, 2) = 10 * std::cos(t) - 10;
    frames[k].grey = test::analytic_image(512, 512, H);
    frames[k].time_s = 0.008 * static_cast<double>(k);
  }
  const auto tracker = tracking::trackers().make("esm", tracking::Camera{}, tracking::TrackerOptions{});
  tracker->start(frames[0], tracking::rectangle(200, 200, side, side));
  std::size_t k = 0;
  double lost = 0;
  for (auto _ : state) {
    tracking::Frame& frame = frames[++k % frames.size()];
    frame.time_s = 0.008 * static_cast<double>(k);
    const auto track = tracker->track(frame);
    lost += track.state == tracking::TrackState::LOST;
    benchmark::DoNotOptimize(track);
  }
  state.counters["lost"] = lost;
}
BENCHMARK(esm)->Arg(40)->Arg(80)->Arg(120)->Unit(benchmark::kMillisecond);

}  // namespace
