// heartservo servo: closes the loop on a scene or on recorded frames, prints the residual table, leaves a run folder.
#include <fmt/format.h>

#include <chrono>

#include "servo/loop/loop.hpp"
#include "servo/loop/score.hpp"
#include "sim/table/stages.hpp"
#include "sim/table/table.hpp"
#include "tools/album.hpp"
#include "tools/command.hpp"
#include "tools/interrupt.hpp"
#include "tools/loop_table.hpp"
#include "tools/overlay.hpp"
#include "tools/progress.hpp"
#include "tools/run_folder.hpp"
#include "tools/servo_report.hpp"
#include "tools/servo_summary.hpp"
#include "tracking/landmark/registry.hpp"
#include "tracking/planar/registry.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_writer.hpp"

namespace heartservo::tools {

namespace {

constexpr double kFlight_s = 2;        // of the flight recording after a safety stop
constexpr double kMostUnscored = 0.9;  // share of a run that may be spent on settling

struct ServoOptions {
  RunOptions run;
  RecordedOptions recorded;
  std::string tracker, estimator, predictor, controller, robot, reference, point;
  double latency_ms = -1, settle_s = -1;
};

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

template <class Registry>
void print_engines(const char* kind, const Registry& registry) {
  for (const auto& engine : registry.engines()) fmt::print("{:<12}{:<24}{}\n", kind, engine.name, engine.summary);
}

int list_engines() {
  print_engines("tracker", tracking::trackers());
  print_engines("estimator", tracking::estimators());
  print_engines("predictor", servo::predictors());
  print_engines("controller", servo::control_laws());
  fmt::print("{:<12}{:<24}{}\n{:<12}{:<24}{}\n", "robot", "cartesian", "second order, limits, encoder noise", "robot",
             "ideal", "follows its reference exactly");
  return DONE;
}

// A run too short for the scene's settling time would score nothing. Unless the command line asks for that time, its
// second half is scored then, and says so.
void fit_settling(sim::Scene& scene, const ServoOptions& o, std::size_t frames, double frame_rate_hz) {
  const double last_s = frames == 0 ? 0 : static_cast<double>(frames - 1) / frame_rate_hz;
  if (o.settle_s >= 0 && o.settle_s > last_s)
    throw ConfigError(
        fmt::format("--settle-s {} leaves nothing to score: the last frame is at {:.3g} s", o.settle_s, last_s));
  if (o.settle_s >= 0 || scene.settle_s <= kMostUnscored * last_s) return;
  if (!o.run.quiet && scene.settle_s > 0)
    fmt::print(stderr, "heartservo: the run ends at {:.3g} s, too soon for settle_s ({} s): scored from {:.3g} s on\n",
               last_s, scene.settle_s, 0.5 * last_s);
  scene.settle_s = 0.5 * last_s;
}

sim::Scene configure(const ServoOptions& o) {
  sim::Scene scene = scene_for(o.run, o.recorded);
  const auto choose = [](std::string& name, const std::string& wanted, const auto& registry) {
    if (wanted.empty()) return;
    registry.require(wanted);
    name = wanted;
  };
  choose(scene.engines.tracker, o.tracker, tracking::trackers());
  choose(scene.engines.estimator, o.estimator, tracking::estimators());
  choose(scene.engines.predictor, o.predictor, servo::predictors());
  choose(scene.engines.controller, o.controller, servo::control_laws());
  if (!o.robot.empty()) scene.robot.type = o.robot;
  if (!o.reference.empty()) scene.recording.reference = std::filesystem::absolute(o.reference).string();
  if (!o.point.empty()) scene.recording.point = o.point;
  if (o.latency_ms >= 0) scene.loop.latency.set_total(1e-3 * o.latency_ms);
  if (o.settle_s >= 0) scene.settle_s = o.settle_s;
  if (o.run.frames && !scene.is_recorded()) fit_settling(scene, o, scene.frame_count(), scene.camera.frame_rate_hz);
  sim::require_valid(scene, o.run.source);
  return scene;
}

ReportPicture overlay(const servo::LoopRecord& r, const servo::TruthSample& truth, tracking::TargetTracker& tracker) {
  ReportPicture picture{"", canvas_of(r.frame), {region_key(r.track)}};
  cv::Mat mask;
  tracker.mark_left_out(mask);
  if (tint_left_out(picture.bgr, mask)) picture.keys.push_back(left_out_key());
  draw_region(picture.bgr, r.track);
  draw_goal_and_tip(picture.bgr, truth.goal_px, truth.tip_px);
  picture.keys.push_back(goal_and_tip_key());
  return picture;
}

int run_servo(const ServoOptions& o) {
  if (o.run.list) return list_engines();
  sim::Scene scene = configure(o);
  const auto table = sim::make_table(scene);
  const servo::LoopOptions loop_options = sim::loop_options(scene, *table);
  servo::LoopStages stages = sim::make_stages(scene, *table);
  tracking::TargetTracker& tracker = *stages.target_tracker;  // for the pictures; the loop owns it
  servo::Loop loop(table->frames(), table->robot(), std::move(stages), loop_options, table->marker_to_tip(), now_s);
  const auto picked = table->picked();
  if (const std::string why = loop.start(picked.target, picked.marker); !why.empty())
    throw ConfigError(fmt::format("{}: the region cannot be tracked: {}", o.run.source, why));

  const std::size_t expected = table->frames().frame_count().value_or(0);
  if (scene.is_recorded() && expected > 0) fit_settling(scene, o, expected, loop_options.frame_rate_hz);
  TimeTable frames = make_loop_table(rows_ahead(expected));
  servo::Score score(scene.settle_s, 1 / loop_options.frame_rate_hz);
  score.reserve(rows_ahead(expected));
  Album album(expected, [](double px) { return fmt::format("{:.1f} px from the goal", px); });
  ServoRunFacts facts;
  RunFolder folder(run_path(o.run, "servo"));
  const double begin = now_s();
  {
    const Interrupt interrupt;
    Progress progress("servo " + stem_of(o.run.source), expected, o.run.quiet);
    servo::LoopRecord record;
    while (!(facts.interrupted = interrupt.requested()) && loop.step(record)) {
      const servo::TruthSample truth = table->truth(record);
      score.add(record, truth);
      append(frames, record, truth);
      const double off_px = record.frame.time_s < scene.settle_s ? NAN : (truth.tip_px - truth.goal_px).norm();
      if (record.frame.status == tracking::FrameStatus::OK)
        album.look_at(
            {frames.rows() - 1, record.frame.time_s, off_px, "", record.track.state == tracking::TrackState::LOST},
            [&] { return overlay(record, truth, tracker); });
      progress.update(frames.rows());
    }
  }
  facts.scene = is_scene(o.run.source) ? stem_of(o.run.source) : o.run.source;
  facts.reference = table->reference();
  facts.reference_point = table->reference_point();
  facts.camera = scene.camera.calibration.empty() ? "assumed pinhole" : scene.camera.calibration;
  facts.frame_rate_hz = loop_options.frame_rate_hz;
  facts.stop_reason = loop.stop_reason();
  facts.real_time_factor =
      static_cast<double>(frames.rows()) / loop_options.frame_rate_hz / std::max(1e-9, now_s() - begin);

  const auto summary = servo_summary(score.summary(), scene, facts);
  frames.write_csv(folder.file("frames.csv"));
  if (!facts.stop_reason.empty()) tail(frames, kFlight_s).write_csv(folder.file("flight.csv"));
  const TimeTable plotted = with_motion(frames);
  finish_run(folder, servo_report(summary, plotted, album.pictures(), config_text(scene, "servo")), o.run,
             residual_table(summary));
  if (!facts.stop_reason.empty()) {
    fmt::print(stderr, "heartservo: safety stop: {}; the last {} s are in {}\n", facts.stop_reason, kFlight_s,
               folder.file("flight.csv").string());
    return SAFETY_STOP;
  }
  return facts.interrupted ? INTERRUPTED : DONE;
}

}  // namespace

Command add_servo_command(CLI::App& program) {
  auto options = std::make_shared<ServoOptions>();
  ServoOptions& o = *options;
  CLI::App* app = program.add_subcommand("servo", "close the loop, print the residual table, leave a run folder");
  add_run_options(*app, o.run, "scene (.yaml), image folder, printf pattern or video");
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
  app->add_option("--predictor", o.predictor, "overrides the scene's predictor");
  app->add_option("--controller", o.controller, "overrides the scene's control law");
  app->add_option("--robot", o.robot, "overrides the scene's robot")->check(one_of({"cartesian", "ideal"}));
  app->add_option("--latency-ms", o.latency_ms, "total latency; the scene's parts keep their proportions")
      ->check(finite(0, 1900));
  app->add_option("--settle-s", o.settle_s, "frames before this are not scored")->check(finite(0, 1e4));
  app->add_flag("--list", o.run.list, "list the engines and exit");
  app->footer(
      "Examples:\n  heartservo servo scenes/pig_2007.yaml\n"
      "  heartservo servo scenes/pig_2007.yaml --predictor hold --controller ibvs --json\n"
      "  heartservo servo recorded/frames --roi 150,130,60,60 --frame-rate-hz 25 --depth-mm 45");
  return {app, [options] { return run_servo(*options); }};
}

}  // namespace heartservo::tools
