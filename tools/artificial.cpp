#include "tools/artificial.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_writer.hpp"

namespace heartservo::tools {

namespace {

struct Config {
  sim::SequenceOptions artificial;
  tracking::TrackerOptions tracking;
  void fields(FieldVisitor& v) {
    v.group("artificial", "the artificial sequence", artificial);
    v.group("tracking", "options of the trackers", tracking);
  }
};

// A picture or folder of the user's, as seen from anywhere; a texture's name stays.
std::string located(const std::string& path) {
  std::error_code error;
  return std::filesystem::exists(path, error) ? std::filesystem::absolute(path).lexically_normal().string() : path;
}

}  // namespace

void add_artificial_options(CLI::App& command, ArtificialChoice& c) {
  constexpr const char* kGroup = "Artificial sequences";
  std::string names;
  for (const auto& kind : sim::sequence_kinds()) names += fmt::format("\n{:>12}  {}", kind.name, kind.summary);
  CLI::Option* name =
      command.add_option("--artificial", c.name, "instead of a source, a sequence of exactly known motion:" + names)
          ->type_name("NAME")
          ->group(kGroup);
  const auto add = [&](const char* flag, auto& value, const char* help) {
    return command.add_option(flag, value, help)->needs(name)->group(kGroup);
  };
  add("--texture", c.texture, "heart, retina, detail (default) or a picture file")->type_name("NAME|FILE");
  add("--side", c.side, "side of the region in px (default 80)")->check(CLI::Range(12, 200));
  add("--place", c.place, "where the region lies: 0, 1 or 2")->check(CLI::Range(0, 2));
  add("--noise", c.noise, "standard deviation of the noise, grey levels")->check(CLI::Range(0.0, 50.0));
  add("--gain", c.gain, "swing of the light's gain: 0.3 for 30 % up and down")->check(CLI::Range(0.0, 0.9));
  add("--bias", c.bias, "swing of the light's bias, grey levels")->check(CLI::Range(0.0, 100.0));
  add("--speculars", c.speculars, "number of moving saturated blobs")->check(CLI::Range(0, 200));
  add("--step", c.step, "times faster: larger steps from frame to frame")->check(CLI::Range(0.01, 100.0));
  add("--background", c.background, "frames under the patch of table5 and circle (default: the simulated heart)")
      ->type_name("SOURCE");
}

sim::SequenceOptions sequence_for(const ArtificialChoice& c, const RunOptions& run) {
  sim::SequenceOptions options = sim::SequenceOptions::named(c.name);
  if (c.texture) options.texture = located(*c.texture);
  if (c.background) options.background = located(*c.background);
  if (c.side) options.side_px = *c.side;
  if (c.place) options.place = *c.place;
  if (c.speculars) options.speculars = *c.speculars;
  if (c.noise) options.noise_grey = *c.noise;
  if (c.gain) options.gain = *c.gain;
  if (c.bias) options.bias_grey = *c.bias;
  if (c.step) options.step = *c.step;
  if (run.seed) options.seed = *run.seed;
  if (run.frames) options.frames = *run.frames;
  const auto problems = options.validate();
  if (!problems.empty()) throw ConfigError(fmt::format("--artificial {}: {}", c.name, fmt::join(problems, "; ")));
  return options;
}

std::string artificial_source(const ArtificialChoice& choice, const RunOptions& run) {
  if (!run.source.empty())
    throw ConfigError(fmt::format("give {} or --artificial {}, not both", run.source, choice.name));
  return "artificial:" + choice.name;
}

std::string config_text(const sim::SequenceOptions& sequence, const tracking::TrackerOptions& tracking,
                        const std::string& command) {
  return fmt::format("# heartservo {} {}: the resolved configuration\n{}", HEARTSERVO_VERSION, command,
                     to_yaml(Config{sequence, tracking}));
}

}  // namespace heartservo::tools
