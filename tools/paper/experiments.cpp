#include "tools/paper/experiments.hpp"

#include <filesystem>

namespace heartservo::tools {

namespace {

const char* const kTrackers = "ssd,correlation,optical_flow,esm,composite";  // those of section 4.4

}  // namespace

std::vector<Experiment> paper_experiments(const std::string& data, int seed, bool short_run) {
  std::vector<Experiment> all{
      {"depth", "Depth on a rail (section 4.1)", {"track", "scenes/depth_rail.yaml"}},
      {"sequence",
       "Motion of two landmarks over 1900 frames (Fig. 4, Tables 3 and 4)",
       {"track", "scenes/two_landmarks.yaml"}},
      {"table5",
       "Vertical translation of an artificial sequence (Table 5, Fig. 6)",
       {"track", "--artificial", "table5", "--speculars", "2", "--tracker", kTrackers}},
      {"figure7",
       "Circle with rotation and scale (Fig. 7)",
       {"track", "--artificial", "circle", "--speculars", "16", "--tracker", kTrackers}},
      {"figure8",
       "Simulated tissue without a landmark (Fig. 8)",
       {"track", "scenes/texture_only.yaml", "--tracker", "composite", "--frames", "750"}},
  };
  std::error_code error;
  const std::filesystem::path frames = std::filesystem::path(data) / "heart_invivo/left";
  if (!data.empty() && std::filesystem::is_directory(frames, error))
    all.push_back({"figure8_recorded",
                   "A recorded heart without a landmark (Fig. 8)",
                   {"track", frames.string(), "--roi", "212,130,50,50", "--tracker", "composite,deformable"}});
  for (auto& experiment : all) {
    const bool recorded = experiment.name == "figure8_recorded";
    if (seed >= 0 && !recorded)
      experiment.arguments.insert(experiment.arguments.end(), {"--seed", std::to_string(seed)});
    if (short_run) {
      const bool moved = experiment.name == "sequence";  // its spectrum wants ten seconds and more
      if (experiment.name == "figure8")
        experiment.arguments.back() = "20";
      else
        experiment.arguments.insert(experiment.arguments.end(), {"--frames", moved ? "1300" : "20"});
    }
  }
  return all;
}

std::string command_line(const Experiment& experiment) {
  std::string line = "heartservo";
  for (const auto& argument : experiment.arguments) line += " " + argument;
  return line;
}

}  // namespace heartservo::tools
