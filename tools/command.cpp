#include "tools/command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tools/report/report.hpp"
#include "tools/report/stored_pictures.hpp"
#include "tools/run_folder.hpp"
#include "tools/shipped.hpp"
#include "tracking/frames/v4l2/camera_options.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"
#include "tracking/settings/yaml_writer.hpp"

namespace heartservo::tools {

namespace {

constexpr double kEndless_s = 1e5;  // the longest run

std::string absolute(const std::string& path) { return std::filesystem::absolute(path).lexically_normal().string(); }

// A path as it can be used from everywhere; a camera is named, not found.
std::string named(const std::string& source) {
  return tracking::v4l2::is_camera(source) ? source : absolute(source);
}

// Defaults for frames from disk: an assumed depth instead of a landmark.
sim::Scene recorded_scene(const std::string& source) {
  sim::Scene scene;
  scene.title = source;
  scene.recording.source = named(source);
  scene.camera.frame_rate_hz = 0;  // the source's own: a video's rate, 25 Hz for pictures
  scene.engines.estimator = "assumed_depth";
  scene.engines.predictor = "hold";      // at 25 frames/s a straight line over 75 ms overshoots more than it helps
  scene.tracking.corner_sigma_px = 0.3;  // bare tissue
  scene.duration_s = kEndless_s;
  return scene;
}

}  // namespace

CLI::Validator finite(double low, double high) {
  const std::string range = fmt::format("[{} - {}]", low, high);
  return {[=](std::string& text) {
            double value = NAN;
            const bool is_number = CLI::detail::lexical_cast(text, value);
            if (is_number && value >= low && value <= high) return std::string();  // false for NaN
            return fmt::format("'{}' must be a number from {} to {}", text, low, high);
          },
          range};
}

CLI::Validator one_of(const std::vector<std::string>& names) {
  return {[=](std::string& text) {
            if (std::find(names.begin(), names.end(), text) != names.end()) return std::string();
            return fmt::format("'{}' is not known{}; choose one of {}", text, did_you_mean(text, names),
                               fmt::join(names, ", "));
          },
          fmt::format("{{{}}}", fmt::join(names, ","))};
}

std::size_t rows_ahead(std::size_t expected_frames) { return std::clamp<std::size_t>(expected_frames, 256, 100000); }

void add_run_options(CLI::App& command, RunOptions& o, const std::string& source_help) {
  command.add_option("source", o.source, source_help);
  command.add_option("--out", o.out, "run folder (default: runs/COMMAND-NAME-DATE)")->type_name("DIR");
  command.add_option("--seed", o.seed, "seed of every random draw")->check(CLI::Range(0, 2000000000));
  command.add_option("--frames", o.frames, "number of frames")->check(CLI::Range(1, 2000000000));
  command.add_flag("--json", o.json, "print summary.json on stdout and nothing else");
  command.add_flag("--quiet", o.quiet, "no progress and no table");
}

CLI::Option* add_repeatable(CLI::App& command, const std::string& name, std::vector<double>& values, std::size_t count,
                            const std::string& help) {
  const auto take = [&values, name, count](const std::vector<std::string>& texts) {
    values.clear();
    const CLI::Validator number = finite(-1e5, 1e5);
    for (const std::string& text : texts) {
      const auto parts = CLI::detail::split(text, ',');
      if (parts.size() != count)
        throw CLI::ValidationError(name, fmt::format("'{}' must be {} numbers separated by commas", text, count));
      for (std::string part : parts) {
        if (const std::string problem = number(part); !problem.empty()) throw CLI::ValidationError(name, problem);
        values.push_back(std::stod(part));
      }
    }
    return true;
  };
  return command.add_option(name, CLI::callback_t(take), help)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false)
      ->type_name("PX,...");
}

void add_recording_options(CLI::App& command, RecordedOptions& o, bool several) {
  if (several)
    add_repeatable(command, "--roi", o.roi, 4,
                   "region in the first frame: x,y,width,height in px; again for further regions");
  else
    command.add_option("--roi", o.roi, "region in the first frame: x,y,width,height in px")
        ->delimiter(',')
        ->expected(4)
        ->check(finite(-1e5, 1e5));
  command
      .add_option("--stereo", o.right,
                  "the right view of a stereo endoscope (as SOURCE, the left one); --camera is a stereo file then")
      ->type_name("RIGHT");
  command.add_option("--camera", o.camera, "camera file (ROS, OpenCV, ViSP, Matlab)")->type_name("FILE");
  command.add_option("--frame-rate-hz", o.frame_rate_hz, "frames per second of recorded frames")
      ->check(finite(0.1, 10000));
}

bool is_scene(const std::string& source) {
  const std::string extension = std::filesystem::path(source).extension().string();
  return extension == ".yaml" || extension == ".yml";
}

sim::Scene scene_for(const RunOptions& run, const RecordedOptions& recorded) {
  if (run.source.empty()) throw ConfigError("SOURCE is missing: give a scene such as scenes/pig_2007.yaml, or frames");
  sim::Scene scene = is_scene(run.source) ? sim::load_scene(shipped(run.source)) : recorded_scene(run.source);
  if (run.seed) scene.seed = *run.seed;
  if (!recorded.roi.empty()) scene.recording.roi = recorded.roi;
  if (!recorded.camera.empty()) scene.camera.calibration = absolute(recorded.camera);
  if (recorded.frame_rate_hz > 0) scene.camera.frame_rate_hz = recorded.frame_rate_hz;
  if (!recorded.right.empty()) {
    if (!scene.is_recorded()) throw ConfigError("--stereo is for recorded frames; a simulated scene has stereo.baseline_m");
    if (scene.camera.calibration.empty())
      throw ConfigError("--stereo needs --camera FILE, a stereo calibration such as 'heartservo calibrate' writes");
    scene.recording.right = absolute(recorded.right);
    scene.engines.estimator = "stereo_depth";
  }
  if (recorded.depth_mm > 0) scene.recording.depth_m = 1e-3 * recorded.depth_mm;
  if (!scene.is_recorded() && (!recorded.roi.empty() || recorded.depth_mm > 0))
    throw ConfigError("--roi and --depth-mm are for recorded frames; a simulated scene has its region under 'target'");
  if (run.frames) scene.max_frames = static_cast<std::size_t>(*run.frames);
  if (run.frames && !scene.is_recorded()) {
    scene.duration_s = static_cast<double>(*run.frames) / scene.camera.frame_rate_hz;
    if (scene.duration_s > kEndless_s)
      throw ConfigError(fmt::format("--frames {} at {} Hz are {:.0f} s; at most {:.0f} s can be simulated", *run.frames,
                                    scene.camera.frame_rate_hz, scene.duration_s, kEndless_s));
  }
  return scene;
}

std::string stem_of(const std::string& source) {
  std::filesystem::path path(source.substr(0, tracking::v4l2::is_camera(source) ? source.find(',') : source.npos));
  if (!path.has_filename()) path = path.parent_path();
  return path.stem().string();
}

std::string config_text(const sim::Scene& scene, const std::string& command) {
  sim::Scene resolved = scene;
  for (std::string* path : {&resolved.camera.calibration, &resolved.recording.source, &resolved.recording.right,
                            &resolved.recording.reference, &resolved.motion.beats, &resolved.ecg.record,
                            &resolved.loop.path.file})
    if (!path->empty()) *path = named(sim::resolve(scene, *path));
  return fmt::format("# heartservo {} {}: the resolved configuration; it can be run again as a scene\n{}",
                     HEARTSERVO_VERSION, command, to_yaml(resolved));
}

void finish_run(RunFolder& folder, const Report& report, const RunOptions& options, const std::string& text) {
  const std::string summary = report.summary.dump(2) + "\n";
  folder.write("config.yaml", report.config_yaml);
  folder.write("summary.json", summary);
  write_pictures(folder.file(""), report.pictures);
  write_report(report, folder.file("report.html"));
  folder.finish();
  if (options.json)
    fmt::print("{}", summary);
  else if (!options.quiet)
    fmt::print("{}\nreport: {}\n", text, folder.file("report.html").string());
}

std::filesystem::path run_path(const RunOptions& options, const std::string& command) {
  return options.out.empty() ? default_run_path(command, stem_of(options.source)) : std::filesystem::path(options.out);
}

}  // namespace heartservo::tools
