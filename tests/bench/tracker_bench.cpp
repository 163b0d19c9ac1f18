// Every tracker of the registry on the same frames, templates of 40, 80 and 120 px: time per frame, mean corner error
// and lost frames as counters, and how many times esm's time it takes (`times_esm`; at visp_esm: the gain over ViSP).
//
// The motion is like the comparison's sequence b: a circle of radius 30 px, rotation +-20 degrees,
// scale +-10 %, perspective 2e-4 and 1.5e-4 per px, noise of 1 grey level; there and back again.
#include <benchmark/benchmark.h>

#include <Eigen/LU>
#include <chrono>
#include <map>
#include <random>

#include "tests/support/analytic_image.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/planar/registry.hpp"

namespace {

using namespace heartservo;
using Clock = std::chrono::steady_clock;

constexpr int kSide = 512, kFrames = 100;

struct Sequence {
  std::vector<tracking::Frame> frames;
  std::vector<Eigen::Matrix3d> H;
};

Eigen::Matrix3d motion(int k) {
  const double t = 2 * M_PI * k, angle = 20 * M_PI / 180 * std::sin(t / 80), scale = 1 + 0.1 * std::sin(t / 67);
  Eigen::Matrix3d H, centred = Eigen::Matrix3d::Identity();
  H << scale * std::cos(angle), -scale * std::sin(angle), 30 * std::sin(t / 100), scale * std::sin(angle),
      scale * std::cos(angle), 30 - 30 * std::cos(t / 100), 2e-4 * std::sin(t / 90), 1.5e-4 * std::sin(t / 60), 1;
  centred(0, 2) = centred(1, 2) = kSide / 2.0;
  return centred * H * centred.inverse();
}

const Sequence& sequence() {
  static const Sequence result = [] {
    Sequence s;
    std::mt19937_64 random(7);
    std::normal_distribution<float> noise(0, 1);
    for (int k = 0; k < kFrames; ++k) {
      s.H.push_back(motion(k));
      s.frames.emplace_back();
      s.frames.back().grey = test::analytic_image(kSide, kSide, s.H.back());
      for (auto& v : cv::Mat_<std::uint8_t>(s.frames.back().grey))
        v = cv::saturate_cast<std::uint8_t>(static_cast<float>(v) + noise(random));
    }
    return s;
  }();
  return result;
}

// A tracker on its way through the sequence, there and back.
class Walk {
 public:
  Walk(const std::string& name, double side)
      : tracker_(tracking::trackers().make(name, tracking::Camera{}, tracking::TrackerOptions{})),
        region_(tracking::rectangle((kSide - side) / 2, (kSide - side) / 2, side, side)) {
    tracker_->start(sequence().frames[0], region_);
  }

  void step() {
    ++k_;
    const int phase = k_ % (2 * kFrames - 2);
    const auto at = static_cast<std::size_t>(phase < kFrames ? phase : 2 * kFrames - 2 - phase);
    tracking::Frame frame = sequence().frames[at];
    frame.time_s = 0.008 * k_;
    const auto begin = Clock::now();
    const tracking::Track track = tracker_->track(frame);
    seconds += std::chrono::duration<double>(Clock::now() - begin).count();
    if (track.state == tracking::TrackState::LOST) {
      ++lost;
      return;
    }
    const tracking::Quad truth = tracking::transform(sequence().H[at], region_);
    for (std::size_t i = 0; i < 4; ++i) error_px += (track.corners[i] - truth[i]).norm() / 4;
    ++followed;
  }

  double seconds = 0, error_px = 0, lost = 0, followed = 0;

 private:
  std::unique_ptr<tracking::TargetTracker> tracker_;
  tracking::Quad region_;
  int k_ = 0;
};

double esm_seconds(int side) {
  static std::map<int, double> known;
  if (!known.count(side)) {
    Walk walk("esm", side);
    for (int k = 0; k < kFrames; ++k) walk.step();
    known[side] = walk.seconds / kFrames;
  }
  return known[side];
}

void tracker(benchmark::State& state, const std::string& name) {
  const double esm = esm_seconds(static_cast<int>(state.range(0)));
  Walk walk(name, static_cast<double>(state.range(0)));
  for (auto _ : state) walk.step();
  state.counters["error_px"] = walk.error_px / std::max(1.0, walk.followed);
  state.counters["lost"] = walk.lost;
  state.counters["times_esm"] = walk.seconds / static_cast<double>(state.iterations()) / esm;
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
