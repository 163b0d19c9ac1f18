// heartservo servo: closes the loop on a scene or on recorded frames, prints the residual table, leaves a run folder.
#include <fmt/format.h>

#include <optional>
#include <sstream>

#include "servo/control/registry.hpp"
#include "sim/robot/registry.hpp"
#include "tools/capture/capture_summary.hpp"
#include "tools/capture/live_timing.hpp"
#include "tools/command.hpp"
#include "tools/frequency_sweep.hpp"
#include "tools/loop_table.hpp"
#include "tools/run_folder.hpp"
#include "tools/servo_comparison.hpp"
#include "tools/servo_report.hpp"
#include "tools/servo_run.hpp"
#include "tools/servo_summary.hpp"
#include "tracking/frames/v4l2/camera_options.hpp"
#include "tracking/landmark/registry.hpp"
#include "tracking/planar/registry.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_writer.hpp"

namespace heartservo::tools {

namespace {

constexpr double kFlight_s = 2;  // of the flight recording after a safety stop

struct ServoOptions {
  RunOptions run;
  RecordedOptions recorded;
  std::string tracker, estimator, predictor, controller, robot, reference, point, sweep;
  double latency_ms = -1, settle_s = -1;
  bool real_time = false, show = false, select = false;
  bool no_video = false;
  int igtl_port = 0;
};

template <class Registry>
void print_engines(const char* kind, const Registry& registry) {
  for (const auto& engine : registry.engines()) fmt::print("{:<12}{:<24}{}\n", kind, engine.name, engine.summary);
}

int list_engines() {
  print_engines("tracker", tracking::trackers());
  print_engines("estimator", tracking::estimators());
  print_engines("predictor", servo::predictors());
  print_engines("controller", servo::control_laws());
  print_engines("robot", sim::robots());
  return DONE;
}

// "a,b", "all" or "" for the scene's own. Throws ConfigError for a name that is not known.
template <class Registry>
std::vector<std::string> names_of(const std::string& list, const std::string& own, const Registry& registry) {
  if (list.empty()) return {own};
  if (list == "all") return registry.names();
  std::vector<std::string> names;
  std::istringstream in(list);
  for (std::string name; std::getline(in, name, ',');) names.push_back(registry.require(name).name);
  if (names.empty()) registry.require(list);
  return names;
}

ServoRequest configure(const ServoOptions& o) {
  ServoRequest request;
  request.scene = scene_for(o.run, o.recorded);
  sim::Scene& scene = request.scene;
  const auto choose = [](std::string& name, const std::string& wanted, const auto& registry) {
    if (!wanted.empty()) name = registry.require(wanted).name;
  };
  choose(scene.engines.tracker, o.tracker, tracking::trackers());
  choose(scene.engines.estimator, o.estimator, tracking::estimators());
  choose(scene.robot.type, o.robot, sim::robots());
  if (!o.reference.empty()) scene.recording.reference = std::filesystem::absolute(o.reference).string();
  if (!o.point.empty()) scene.recording.point = o.point;
  if (o.latency_ms >= 0) scene.loop.latency.set_total(1e-3 * o.latency_ms);
  if (o.settle_s >= 0) scene.settle_s = o.settle_s;
  request.source = o.run.source;
  request.label = "servo " + stem_of(o.run.source);
  request.settle_s = o.settle_s;
  request.quiet = o.run.quiet;
  request.igtl_port = o.igtl_port;
  request.real_time = o.real_time;
  request.show = o.show || o.select;
  request.select = o.select;
  if (o.run.frames && !scene.is_recorded()) fit_settling(request, scene.frame_count(), scene.camera.frame_rate_hz);
  return request;
}

// A run folder from a finished loop; what several loops had to say comes first in the report.
int finish(const ServoOptions& o, RunFolder& folder, ServoOutcome& outcome, const std::string& text,
           const ReportTable* extra) {
  outcome.frames.write_csv(folder.file("frames.csv"));
  if (!outcome.stop_reason.empty()) tail(outcome.frames, kFlight_s).write_csv(folder.file("flight.csv"));
  const TimeTable plotted = with_motion(outcome.frames);
  const TimeTable spectrum = servo_spectrum(plotted, outcome.summary);
  Report report =
      servo_report(outcome.summary, plotted, spectrum, outcome.pictures, config_text(outcome.scene, "servo"));
  if (outcome.summary.contains("capture")) {
    report.tables.push_back(capture_table(outcome.summary["capture"]));
    report.tables.push_back(event_table(outcome.summary["capture"]));
  }
  report.video = outcome.video;
  if (extra != nullptr) report.tables.insert(report.tables.begin(), *extra);
  finish_run(folder, report, o.run, text);
  if (!outcome.stop_reason.empty() && extra == nullptr) {
    fmt::print(stderr, "heartservo: safety stop: {}; the last {} s are in {}\n", outcome.stop_reason, kFlight_s,
               folder.file("flight.csv").string());
    return SAFETY_STOP;
  }
  if (!outcome.device_failure.empty())
    throw DeviceError(fmt::format("{}; the frames before are in {}", outcome.device_failure, folder.path().string()));
  return outcome.interrupted ? INTERRUPTED : DONE;
}

int run_servo(const ServoOptions& o) {
  if (o.run.list) return list_engines();
  ServoRequest request = configure(o);
  auto& engines = request.scene.engines;
  const auto predictors = names_of(o.predictor, engines.predictor, servo::predictors());
  const auto controllers = names_of(o.controller, engines.controller, servo::control_laws());
  engines.predictor = predictors.front();
  engines.controller = controllers.front();
  sim::require_valid(request.scene, o.run.source);
  std::optional<RunFolder> folder;
  request.before_run = [&]() -> std::filesystem::path {
    if (!folder) folder.emplace(run_path(o.run, "servo"));
    const bool several = !o.sweep.empty() || predictors.size() * controllers.size() > 1;
    const bool live = tracking::v4l2::is_camera(request.scene.recording.source);  // a film would take the loop's time
    return several || live || o.no_video ? std::filesystem::path() : folder->file("video.webm");
  };
  if (request.show && (!o.sweep.empty() || predictors.size() * controllers.size() > 1))
    throw ConfigError("--show and --select are for one run: give one predictor and one controller, no sweep");
  if (tracking::v4l2::is_camera(request.scene.recording.source) && predictors.size() * controllers.size() > 1)
    throw ConfigError("a camera's frames come only once: give one predictor and one controller");
  if (!o.sweep.empty()) {
    if (predictors.size() > 1) throw ConfigError("--sweep-frequency compares control laws; give one predictor");
    const auto [low, high] = parse_sweep(o.sweep);
    FrequencySweep swept = sweep(request, low, high, controllers);
    swept.last.summary["sweep"] = swept.rows;
    swept.last.interrupted = swept.interrupted;
    const ReportTable table = sweep_table(swept.rows);
    return finish(o, *folder, swept.last, sweep_text(swept.rows), &table);
  }
  if (predictors.size() * controllers.size() > 1) {
    ServoComparison comparison = compare(request, predictors, controllers);
    comparison.best.summary["comparison"] = comparison.rows;
    comparison.best.interrupted = comparison.interrupted;
    const ReportTable table = comparison_table(comparison.rows);
    return finish(o, *folder, comparison.best,
                  comparison_text(comparison.rows) + "\nThe best of them:\n" + residual_table(comparison.best.summary),
                  &table);
  }
  ServoOutcome outcome = run_loop(request);
  std::string text = residual_table(outcome.summary);
  if (outcome.summary.contains("live"))
    text += "\n" + live_text(outcome.summary["live"]) + "\n" + capture_text(outcome.summary["capture"]);
  return finish(o, *folder, outcome, text, nullptr);
}

}  // namespace

Command add_servo_command(CLI::App& program) {
  auto options = std::make_shared<ServoOptions>();
  ServoOptions& o = *options;
  CLI::App* app = program.add_subcommand("servo", "close the loop, print the residual table, leave a run folder");
  add_run_options(*app, o.run, "scene (.yaml), image folder, printf pattern, video, recording or v4l2:/dev/video0");
  add_recording_options(*app, o.recorded);
  app->add_option("--depth-mm", o.recorded.depth_mm, "assumed distance of the region in recorded frames")
      ->check(finite(1, 10000));
  app->add_option("--reference", o.reference,
                  "CSV of annotated points (frame or time_s, point, u_px, v_px, visible), to score recorded frames")
      ->type_name("FILE");
  app->add_option("--point", o.point, "which of them; default: the one inside the region nearest to its centre")
      ->type_name("NAME");
  app->add_option("--tracker", o.tracker, "overrides the scene's tracker");
  app->add_option("--estimator", o.estimator, "overrides the scene's estimator");
  app->add_option("--predictor", o.predictor, "overrides the scene's predictor; several (A,B) or all: side by side")
      ->type_name("NAME");
  app->add_option("--controller", o.controller, "overrides the scene's control law; several (A,B) or all: side by side")
      ->type_name("NAME");
  app->add_option("--robot", o.robot, "overrides the scene's robot");
  app->add_option("--latency-ms", o.latency_ms, "total latency; the scene's parts keep their proportions")
      ->check(finite(0, 1900));
  app->add_option("--sweep-frequency", o.sweep,
                  "residual and margins against a sine target of frequencies from LOW to HIGH, in Hz")
      ->type_name("LOW:HIGH");
  app->add_option("--settle-s", o.settle_s, "frames before this are not scored")->check(finite(0, 1e4));
  app->add_option("--igtl", o.igtl_port, "send target, tip and picture to OpenIGTLink clients on this port (18944)")
      ->check(CLI::Range(1, 65535))
      ->type_name("PORT");
  app->add_flag("--show", o.show,
                "a window with picture, region, tip and numbers; keys: space pause, r learn anew, q end");
  app->add_flag("--select", o.select, "the same, and the region's four corners are clicked in the first frame");
  app->add_flag("--real-time", o.real_time,
                "on a camera: real-time scheduling where allowed, memory locked, no pictures and no progress");
  app->add_flag("--no-video", o.no_video, "no short film of the run in the report");
  app->add_flag("--list", o.run.list, "list the engines and exit");
  app->footer(
      "Examples:\n  heartservo servo scenes/pig_2007.yaml\n"
      "  heartservo servo scenes/pig_2007.yaml --predictor hold --controller ibvs --json\n"
      "  heartservo servo scenes/pig_2007.yaml --controller ibvs,mpc --predictor hold,constant_acceleration\n"
      "  heartservo servo recorded/frames --roi 150,130,60,60 --frame-rate-hz 25 --depth-mm 45");
  return {app, [options] { return run_servo(*options); }};
}

}  // namespace heartservo::tools
