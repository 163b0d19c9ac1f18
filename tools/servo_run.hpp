#pragma once
// One closed loop, from scene to summary: what `servo` does once, and its comparisons and sweeps many times.
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/scene/scene.hpp"
#include "tools/report/report.hpp"
#include "tools/time_table.hpp"

namespace heartservo::tools {

struct ServoRequest {
  sim::Scene scene;
  std::string source;    ///< as the command line names it
  std::string label;     ///< of the progress bar
  double settle_s = -1;  ///< asked for on the command line; below 0: the scene's
  bool quiet = false;
  int igtl_port = 0;       ///< poses and pictures go out on this port, see igtl_stream.hpp; 0: they do not
  bool show = false;       ///< the picture in a window while it runs
  bool pictures = true;    ///< for the report
  bool select = false;     ///< the region is selected there, in the first frame; needs show
  bool real_time = false;  ///< see real_time.hpp; the pictures of the report are left out
  /// Called when nothing stands against the run any more. Returns where a short film of it goes; empty: none is made.
  std::function<std::filesystem::path()> before_run;
};

struct ServoOutcome {
  nlohmann::json summary;
  TimeTable frames{{"time_s"}};
  std::vector<ReportPicture> pictures;
  ReportVideo video;  ///< no file when none was made
  sim::Scene scene;   ///< as it was run
  std::string stop_reason;
  std::string device_failure;  ///< the camera did not come back
  bool interrupted = false;
};

/// A run too short for the scene's settling time would score nothing. Unless the command line asks for that time, its
/// second half is scored then, and says so. Throws ConfigError.
void fit_settling(ServoRequest& request, std::size_t frames, double frame_rate_hz);

/// Throws ConfigError for what is refused before the run, InputError for what cannot be read.
ServoOutcome run_loop(ServoRequest request);

}  // namespace heartservo::tools
