#pragma once
// The depth experiment (section 4.1) as a run: table beside the paper's numbers, run folder.
#include <nlohmann/json.hpp>
#include <vector>

#include "sim/experiment/depth_rail.hpp"
#include "tools/command.hpp"
#include "tools/track_tables.hpp"

namespace heartservo::tools {

/// The rows beside the paper's 0.8 mm and 0.34 mm. `laser_m`: precision of the laser, for the note.
PaperTable depth_rail_table(const std::vector<sim::DepthRailRow>& rows, double laser_m);

/// Runs the scene's experiment and leaves a run folder; the command's exit code.
int run_depth_rail(const RunOptions& options, const sim::Scene& scene);

}  // namespace heartservo::tools
