#pragma once
// What the commands share. A command is one file, NAME_command.cpp, that adds itself to the program in main.cpp.
#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>

#include "sim/scene/scene.hpp"

namespace heartservo::tools {

class RunFolder;
struct Report;

/// Exit codes (a contract: scripts depend on them).
enum ExitCode {
  DONE = 0,
  INTERNAL_ERROR = 1,
  WRONG_USAGE = 2,
  BAD_INPUT = 3,
  DEVICE_TROUBLE = 4,
  SAFETY_STOP = 5,
  INTERRUPTED = 130
};

/// A subcommand and what it does once parsed.
struct Command {
  CLI::App* app;
  std::function<int()> run;
};

Command add_servo_command(CLI::App& program);
Command add_track_command(CLI::App& program);
Command add_render_command(CLI::App& program);
Command add_texture_command(CLI::App& program);
Command add_scene_command(CLI::App& program);
Command add_calibrate_command(CLI::App& program);
Command add_camera_command(CLI::App& program);
Command add_predict_command(CLI::App& program);
Command add_analyse_command(CLI::App& program);
Command add_beats_command(CLI::App& program);
Command add_stabilise_command(CLI::App& program);
Command add_capture_command(CLI::App& program);
Command add_paper_command(CLI::App& program);
Command add_report_command(CLI::App& program);
Command add_doctor_command(CLI::App& program);
Command add_sweep_command(CLI::App& program);

/// A check for options: a finite number from `low` to `high`. CLI::Range lets NaN pass.
CLI::Validator finite(double low, double high);

/// A check for options: one of `names`, with a "did you mean".
CLI::Validator one_of(const std::vector<std::string>& names);

/// Options of every command that makes a run.
struct RunOptions {
  std::string source;
  std::string out;
  bool json = false, quiet = false, list = false;
  std::optional<int> seed, frames;
};
void add_run_options(CLI::App& command, RunOptions& options, const std::string& source_help);

/// How to look at a recorded source; add_recording_options() gives them to a command.
struct RecordedOptions {
  std::vector<double> roi;
  std::string camera;
  std::string right;  ///< the right view of a stereo endoscope
  double frame_rate_hz = 0, depth_mm = 0;
};
/// `several`: --roi may be given more than once.
void add_recording_options(CLI::App& command, RecordedOptions& options, bool several = false);

/// An option that may be given more than once, `count` numbers separated by commas each time; they go one after the
/// other into `values`.
CLI::Option* add_repeatable(CLI::App& command, const std::string& name, std::vector<double>& values, std::size_t count,
                            const std::string& help);

/// True for a scene file (.yaml or .yml), false for frames.
bool is_scene(const std::string& source);

/// The scene that `source` names, or one made around recorded frames, with the command line's choices in it. Throws
/// ConfigError, InputError.
sim::Scene scene_for(const RunOptions& run, const RecordedOptions& recorded);

/// "pig_2007" of scenes/pig_2007.yaml, "left" of heart/left/.
std::string stem_of(const std::string& source);

/// config.yaml: the resolved scene, with the program's version and the command in a comment. Its paths are absolute, so
/// that it is itself a scene that can be run.
std::string config_text(const sim::Scene& scene, const std::string& command);

/// Rows to make room for: the frames expected, within reason (0: nobody knows).
std::size_t rows_ahead(std::size_t expected_frames);

/// Ends a run: config.yaml, summary.json and report.html from the report, the folder under its name, and on stdout the
/// summary (--json) or `text` and where the report is, unless --quiet.
void finish_run(RunFolder& folder, const Report& report, const RunOptions& options, const std::string& text);

/// Where the run goes: --out, or a folder made of command, source and date.
std::filesystem::path run_path(const RunOptions& options, const std::string& command);

}  // namespace heartservo::tools
