#pragma once
// --artificial NAME and what goes with it, for the commands that can run on an artificial sequence.
#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "sim/sequence/sequence_options.hpp"
#include "tools/command.hpp"

namespace heartservo::tools {

/// What the command line says about an artificial sequence; unset: as the sequence has it.
struct ArtificialChoice {
  std::string name;
  std::optional<std::string> texture, background;
  std::optional<int> side, place, speculars;
  std::optional<double> noise, gain, bias, step;

  explicit operator bool() const { return !name.empty(); }
};
void add_artificial_options(CLI::App& command, ArtificialChoice& choice);

/// The sequence asked for, with --seed and --frames. Throws ConfigError.
sim::SequenceOptions sequence_for(const ArtificialChoice& choice, const RunOptions& run);

/// "artificial:b": what such a run is called where others have the name of their source. Throws ConfigError when a
/// source is given as well.
std::string artificial_source(const ArtificialChoice& choice, const RunOptions& run);

/// config.yaml of such a run.
std::string config_text(const sim::SequenceOptions& sequence, const tracking::TrackerOptions& tracking,
                        const std::string& command);

}  // namespace heartservo::tools
