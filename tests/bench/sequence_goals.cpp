// heartservo_sequence_goals: trackers over the artificial sequences at sides of 40, 80 and 120 px, two textures and
// three places, against exact truth. Prints one row per tracker, sequence and side over the (textures x places) runs:
//
//   refused runs in whose region the tracker finds too little texture to start; the others count below
//   kept    runs not lost; lost: LOST or over 5 px off in the last frame
//   px      mean corner error over the frames of the kept runs that are not LOST; max: the largest
//   target  mean error of the region's centre (Track::target)
//   floor   what no unbiased estimate can go below at the sequence's noise, on the first frame without blobs
//   lost    LOST frames of all runs
//   wrong   frames called OK that are over 5 px off, of all runs
//   ms      median and 99th percentile of track(), CPU time, over all frames
//
// Frames are made once and shared by all sides and trackers; nothing is written to disk.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <cstdio>
#include <ctime>
#include <map>

#include "servo/loop/score.hpp"
#include "sim/sequence/artificial_sequence.hpp"
#include "tests/support/error_floor.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/planar/registry.hpp"

namespace {

using namespace heartservo;

constexpr double kLost_px = 5;

struct Choice {
  std::vector<std::string> trackers{"esm"}, sequences{"a", "b", "c", "d", "e", "cde", "fast"},
      textures{"detail", "retina"};
  std::vector<int> sides{40, 80, 120}, places{0, 1, 2};
  std::vector<int> seeds{1};
  tracking::TrackerOptions options;
  bool verbose = false;
};

struct Cell {
  int runs = 0, kept = 0, refused = 0;
  std::size_t lost_frames = 0, wrong_ok = 0;
  double floor_px = 0;
  std::vector<double> errors_px, target_px, ms;
  double max_px = 0;
};

struct Run {
  std::vector<double> errors_px, target_px, ms;
  std::size_t lost_frames = 0, wrong_ok = 0;
  bool kept = false, refused = false;
  double max_px = 0;
};

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double corner_error(const tracking::Quad& a, const tracking::Quad& b) {
  double error = 0;
  for (std::size_t i = 0; i < 4; ++i) error += (a[i] - b[i]).norm() / 4;
  return error;
}

Run run(const std::string& tracker_name, const tracking::TrackerOptions& options,
        const std::vector<tracking::Frame>& frames, const sim::ArtificialSequence& truth) {
  const auto tracker = tracking::trackers().make(tracker_name, tracking::Camera{}, options);
  Run result;
  if (const std::string why = tracker->start(frames[0], truth.region()); !why.empty()) {
    fmt::print(stderr, "{} refuses {}: {}\n", tracker_name, truth.description(), why);
    result.refused = true;
    return result;
  }
  for (std::size_t k = 1; k < frames.size(); ++k) {
    const double begin = cpu_ms();
    const tracking::Track track = tracker->track(frames[k]);
    result.ms.push_back(cpu_ms() - begin);
    const double error = corner_error(track.corners, truth.corners(k));
    const bool lost = track.state == tracking::TrackState::LOST;
    result.lost_frames += lost;
    result.wrong_ok += track.state == tracking::TrackState::OK && !(error <= kLost_px);
    if (!lost) {
      result.errors_px.push_back(error);
      const Eigen::Vector2d target =
          (truth.H_current_reference(k) * tracking::centre(truth.region()).homogeneous()).hnormalized();
      result.target_px.push_back((track.target - target).norm());
      result.max_px = std::max(result.max_px, error);
    }
    result.kept = !lost && error <= kLost_px;
  }
  return result;
}

double floor_of(const sim::SequenceOptions& options, const std::shared_ptr<const sim::BasePicture>& base) {
  sim::SequenceOptions clean = options;
  clean.noise_grey = 0;
  clean.speculars = 0;
  sim::ArtificialSequence sequence(clean, base);
  tracking::Frame frame;
  sequence.next(frame);
  return test::corner_error_floor(frame.grey, sequence.region(), options.noise_grey);
}

// All sides and trackers on the same frames, where the frames do not depend on the side.
void run_place(const Choice& o, sim::SequenceOptions options, const std::shared_ptr<const sim::BasePicture>& base,
               std::map<std::pair<std::string, int>, Cell>& cells) {
  std::vector<tracking::Frame> frames;
  for (const int side : o.sides) {
    options.side_px = side;
    sim::ArtificialSequence sequence(options, base);
    if (frames.empty() || sim::sequence_kind(options.sequence).patch) {
      frames.clear();
      for (tracking::Frame frame; sequence.next(frame);) frames.push_back(frame);
    }
    const double floor_px = floor_of(options, base);
    for (const auto& name : o.trackers) {
      const Run r = run(name, o.options, frames, sequence);
      if (o.verbose)
        fmt::print(stderr, "{:<12} {:<70} {} error {:.3f} max {:.2f} floor {:.3f} lost {} wrong {}\n", name,
                   sequence.description(), r.kept ? "kept" : "LOST", servo::spread_of(r.errors_px).mean, r.max_px,
                   floor_px, r.lost_frames, r.wrong_ok);
      Cell& cell = cells[{name, side}];
      cell.refused += r.refused;
      if (r.refused) continue;
      ++cell.runs;
      cell.lost_frames += r.lost_frames;
      cell.wrong_ok += r.wrong_ok;
      cell.floor_px += floor_px;
      cell.ms.insert(cell.ms.end(), r.ms.begin(), r.ms.end());
      if (!r.kept) continue;
      ++cell.kept;
      cell.max_px = std::max(cell.max_px, r.max_px);
      cell.errors_px.insert(cell.errors_px.end(), r.errors_px.begin(), r.errors_px.end());
      cell.target_px.insert(cell.target_px.end(), r.target_px.begin(), r.target_px.end());
    }
  }
}

void sweep(const Choice& o) {
  fmt::print("{:<14}{:<8}{:>5}{:>9}{:>8}{:>9}{:>9}{:>9}{:>9}{:>7}{:>7}{:>9}{:>9}\n", "tracker", "seq", "side",
             "refused", "kept", "px", "floor", "max", "target", "lost", "wrong", "ms p50", "ms p99");
  std::map<std::pair<std::string, int>, std::shared_ptr<const sim::BasePicture>> bases;
  for (const auto& name : o.sequences) {
    std::map<std::pair<std::string, int>, Cell> cells;
    sim::SequenceOptions options = sim::SequenceOptions::named(name);
    for (const int seed : o.seeds)
      for (const auto& texture : o.textures) {
        options.seed = seed;
        options.texture = texture;
        auto& base = bases[{texture, seed}];
        if (!base) base = sim::base_picture_of(options);
        for (const int place : o.places) {
          options.place = place;
          run_place(o, options, base, cells);
        }
      }
    for (const auto& tracker : o.trackers)
      for (const int side : o.sides) {
        const Cell& c = cells[{tracker, side}];
        const std::string error = c.kept ? fmt::format("{:.4f}", servo::spread_of(c.errors_px).mean) : "-";
        fmt::print("{:<14}{:<8}{:>5}{:>9}{:>8}{:>9}{:>9.4f}{:>9.3f}{:>9.4f}{:>7}{:>7}{:>9.3f}{:>9.3f}\n", tracker, name,
                   side, c.refused, fmt::format("{}/{}", c.kept, c.runs), error, c.floor_px / std::max(1, c.runs),
                   c.max_px, servo::spread_of(c.target_px).mean, c.lost_frames, c.wrong_ok, servo::percentile(c.ms, 50),
                   servo::percentile(c.ms, 99));
      }
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Choice o;
  CLI::App app("trackers over the artificial sequences, against exact truth");
  app.add_option("--trackers", o.trackers, "separated by commas, or 'all'")->delimiter(',')->capture_default_str();
  app.add_option("--sequences", o.sequences, "of a, b, c, d, e, cde, fast, table5, circle")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--textures", o.textures, "heart, retina, detail or picture files")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--sides", o.sides, "px")->delimiter(',')->capture_default_str();
  app.add_option("--places", o.places, "of 0, 1, 2")->delimiter(',')->capture_default_str();
  app.add_option("--seeds", o.seeds, "each one more set of runs")->delimiter(',')->capture_default_str();
  app.add_option("--weighting", o.options.composite.weighting, "of composite: fixed, eq13, eq14")
      ->capture_default_str();
  app.add_option("--texture-weight", o.options.composite.texture_weight, "of composite, where it is fixed")
      ->capture_default_str();
  app.add_flag("--verbose", o.verbose, "a line per run on stderr");
  CLI11_PARSE(app, argc, argv);
  try {
    if (o.trackers == std::vector<std::string>{"all"}) o.trackers = tracking::trackers().names();
    for (const auto& name : o.trackers) tracking::trackers().require(name);
    sweep(o);
  } catch (const std::exception& e) {
    fmt::print(stderr, "heartservo_sequence_goals: {}\n", e.what());
    return 2;
  }
  return 0;
}
