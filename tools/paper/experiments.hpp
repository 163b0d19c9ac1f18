#pragma once
// The experiments of the paper's section 4, each of them a command line that anybody can run alone.
#include <string>
#include <vector>

namespace heartservo::tools {

struct Experiment {
  std::string name;                    ///< of its run folder
  std::string title;                   ///< "Depth on a rail (section 4.1)"
  std::vector<std::string> arguments;  ///< of the program, without --out, --seed, --quiet
};

/// `data`: folder of recorded data, "" for none; the experiment on a recorded heart is left out without it. `seed`
/// below 0: each as its scene has it. `short_run`: a few frames of each, to see that all work.
std::vector<Experiment> paper_experiments(const std::string& data, int seed, bool short_run);

/// "heartservo track scenes/depth_rail.yaml"
std::string command_line(const Experiment& experiment);

}  // namespace heartservo::tools
