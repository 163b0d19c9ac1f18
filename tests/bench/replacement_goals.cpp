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

#include "tests/sim/sequence/replacement_visits.hpp"

namespace {

using namespace heartservo;

struct Choice {
  std::vector<std::string> trackers{"esm", "composite"}, textures{"heart", "retina", "detail"}, replacements;
  std::vector<int> sides{40, 80, 120}, places{0, 1, 2};
  std::string sequence = "b";
  test::Visits visits;
  int seed = 1;
  bool verbose = false;
};

void say(const std::string& name, int frame, const tracking::Track& track, double error_px) {
  fmt::print(stderr, "{} gone for {}: {} quality {:.3f} gain {:.2f} bias {:.0f} noise {:.1f} error {:.0f} px\n", name,
             frame, tracking::name_of(track.state), track.quality, track.gain, track.bias, track.noise_grey, error_px);
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
  app.add_option("--gone", o.visits.gone, "frames without the region, per visit")->capture_default_str();
  app.add_option("--there", o.visits.there, "frames with it")->capture_default_str();
  app.add_option("--visits", o.visits.visits, "how often it goes and comes back")->capture_default_str();
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
      std::map<std::pair<std::string, std::string>, test::VisitCount> cells;
      const auto& loops = loops_of(texture, o.seed);
      for (std::size_t place = 0; place < o.places.size(); ++place)
        for (const auto& replacement : o.replacements) {
          const bool painted = replacement == "noise" || replacement == "grey";
          const auto* other = painted ? nullptr : &loops_of(replacement, o.seed + 70)[place];
          for (const auto& name : o.trackers) {
            test::ReplacedRegion picture(loops[place], side, replacement, other, 5);
            auto& count = cells[{name, replacement}];
            const auto watch = [&](int i, const tracking::Track& t, double error_px) { say(name, i, t, error_px); };
            test::count_visits(o.visits, name, picture, count, o.verbose ? watch : test::WatchFrame());
            if (!count.refused.empty()) fmt::print(stderr, "{} {}: {}\n", texture, side, count.refused);
          }
        }
      for (const auto& name : o.trackers)
        for (const auto& replacement : o.replacements) {
          const test::VisitCount& c = cells[{name, replacement}];
          const auto worst = [&](int n, int never) {
            return never ? fmt::format("never*{}", never) : fmt::format("{}", n);
          };
          fmt::print("{:<14}{:<8}{:>5} {:<12}{:>8}{:>10}{:>10}{:>9}{:>8}{:>7}\n", name, texture, side, replacement,
                     worst(c.to_lost, c.never_lost), c.frames_gone, c.false_ok, c.uncertain, worst(c.to_ok, c.never_ok),
                     c.wrong);
        }
      std::fflush(stdout);
    }
  return 0;
}
