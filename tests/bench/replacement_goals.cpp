// heartservo_replacement_goals: what every tracker does when its region is replaced by noise, grey or other tissue and
// comes back (tests/sim/sequence/replaced_region.hpp). A row per tracker, texture, side and replacement, over the
// places:
//
//   to lost   frames until LOST is said and kept for three frames; the largest of all visits ("never" if not)
//   false OK  frames called OK while the region is gone, of so many
//   uncert.   frames called UNCERTAIN while it is gone
//   to OK     frames until OK within 3 px of the truth once it is back; the largest of all visits ("never" if not)
//   wrong     frames called OK over 5 px off while the region is there
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>

#include "tests/sim/sequence/replaced_region.hpp"
#include "tracking/planar/registry.hpp"

namespace {

using namespace heartservo;

struct Choice {
  std::vector<std::string> trackers{"esm", "composite"}, textures{"heart", "retina", "detail"}, replacements;
  std::vector<int> sides{40, 80, 120}, places{0, 1, 2};
  std::string sequence = "b";
  int gone = 60, there = 17, visits = 3;
  int seed = 1;
  bool verbose = false;
};

struct Cell {
  int frames = 0, false_ok = 0, uncertain = 0, wrong = 0, to_lost = 0, to_ok = 0, never_lost = 0, never_ok = 0,
      visits = 0;
};

double error_of(const tracking::Track& track, const tracking::Quad& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += (track.corners[i] - truth[i]).norm() / 4;
  return sum;
}

void run(const Choice& o, const std::string& name, test::ReplacedRegion& picture, Cell& c) {
  const auto tracker = tracking::trackers().make(name, tracking::Camera{}, tracking::TrackerOptions{});
  std::size_t k = 0;
  if (!tracker->start(picture.frame(k++, false), picture.region()).empty()) return;
  for (int i = 0; i < o.there; ++i) tracker->track(picture.frame(k++, false));
  for (int visit = 0; visit < o.visits; ++visit) {
    int last_not_lost = 0;
    for (int i = 1; i <= o.gone; ++i) {
      const tracking::Track track = tracker->track(picture.frame(k++, true));
      if (o.verbose && track.state != tracking::TrackState::LOST)
        fmt::print(stderr, "{} gone for {}: {} quality {:.3f} gain {:.2f} bias {:.0f} noise {:.1f} error {:.0f} px\n",
                   name, i, tracking::name_of(track.state), track.quality, track.gain, track.bias, track.noise_grey,
                   error_of(track, picture.corners(k - 1)));
      c.false_ok += track.state == tracking::TrackState::OK;
      c.uncertain += track.state == tracking::TrackState::UNCERTAIN;
      if (track.state != tracking::TrackState::LOST && i < 20) last_not_lost = i;
      ++c.frames;
    }
    c.never_lost += last_not_lost >= 19;
    c.to_lost = std::max(c.to_lost, last_not_lost + 1);
    int needed = 0;
    for (int i = 1; i <= o.there; ++i) {
      const tracking::Track track = tracker->track(picture.frame(k, false));
      const double error = error_of(track, picture.corners(k++));
      const bool ok = track.state == tracking::TrackState::OK;
      c.wrong += ok && !(error < 5);
      if (!needed && ok && error < 3) needed = i;
    }
    c.never_ok += needed == 0;
    c.to_ok = std::max(c.to_ok, needed);
    ++c.visits;
  }
}

}  // namespace

int main(int argc, char** argv) {
  Choice o;
  CLI::App app("trackers whose region is replaced for a while");
  app.add_option("--trackers", o.trackers, "separated by commas, or 'all'")->delimiter(',')->capture_default_str();
  app.add_option("--textures", o.textures, "heart, retina, detail")->delimiter(',')->capture_default_str();
  app.add_option("--replacements", o.replacements, "noise, grey, heart, retina, detail; all without it")
      ->delimiter(',');
  app.add_option("--sides", o.sides, "px")->delimiter(',')->capture_default_str();
  app.add_option("--places", o.places, "of 0, 1, 2")->delimiter(',')->capture_default_str();
  app.add_option("--sequence", o.sequence, "how all moves")->capture_default_str();
  app.add_option("--gone", o.gone, "frames without the region, per visit")->capture_default_str();
  app.add_option("--there", o.there, "frames with it")->capture_default_str();
  app.add_option("--visits", o.visits, "how often it goes and comes back")->capture_default_str();
  app.add_option("--seed", o.seed, "of the pictures")->capture_default_str();
  app.add_flag("--verbose", o.verbose, "a line for each frame that is not LOST while it should be");
  CLI11_PARSE(app, argc, argv);
  if (o.replacements.empty()) o.replacements = test::replacements();
  if (o.trackers == std::vector<std::string>{"all"}) o.trackers = tracking::trackers().names();
  fmt::print("{:<14}{:<8}{:>5} {:<12}{:>8}{:>10}{:>10}{:>9}{:>8}{:>7}\n", "tracker", "texture", "side", "replaced by",
             "to lost", "frames", "false OK", "uncert.", "to OK", "wrong");
  std::map<std::pair<std::string, int>, std::vector<test::FrameLoop>> tissue;  // by texture and seed: of each place
  const auto loops_of = [&](const std::string& texture, int seed) -> const std::vector<test::FrameLoop>& {
    auto& loops = tissue[{texture, seed}];
    if (!loops.empty()) return loops;
    sim::SequenceOptions options = sim::SequenceOptions::named(o.sequence);
    options.texture = texture;
    options.seed = seed;
    const auto base = sim::base_picture_of(options);
    for (const int place : o.places) {
      options.place = place;
      loops.emplace_back(options, base);
    }
    return loops;
  };
  for (const auto& texture : o.textures)
    for (const int side : o.sides) {
      std::map<std::pair<std::string, std::string>, Cell> cells;
      const auto& loops = loops_of(texture, o.seed);
      for (std::size_t place = 0; place < o.places.size(); ++place)
        for (const auto& replacement : o.replacements) {
          const bool painted = replacement == "noise" || replacement == "grey";
          const auto* other = painted ? nullptr : &loops_of(replacement, o.seed + 70)[place];
          for (const auto& name : o.trackers) {
            test::ReplacedRegion picture(loops[place], side, replacement, other, 5);
            run(o, name, picture, cells[{name, replacement}]);
          }
        }
      for (const auto& name : o.trackers)
        for (const auto& replacement : o.replacements) {
          const Cell& c = cells[{name, replacement}];
          const auto worst = [&](int n, int never) {
            return never ? fmt::format("never*{}", never) : fmt::format("{}", n);
          };
          fmt::print("{:<14}{:<8}{:>5} {:<12}{:>8}{:>10}{:>10}{:>9}{:>8}{:>7}\n", name, texture, side, replacement,
                     worst(c.to_lost, c.never_lost), c.frames, c.false_ok, c.uncertain, worst(c.to_ok, c.never_ok),
                     c.wrong);
        }
      std::fflush(stdout);
    }
  return 0;
}
