// heartservo track: follows a region with one or several trackers side by side.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "servo/loop/loop_record.hpp"
#include "sim/sequence/sequence_table.hpp"
#include "sim/table/table.hpp"
#include "tools/artificial.hpp"
#include "tools/command.hpp"
#include "tools/corner_truth.hpp"
#include "tools/interrupt.hpp"
#include "tools/overlay.hpp"
#include "tools/progress.hpp"
#include "tools/report/report.hpp"
#include "tools/run_folder.hpp"
#include "tools/servo_summary.hpp"
#include "tools/track_run.hpp"
#include "tools/trajectory.hpp"
#include "tracking/landmark/registry.hpp"
#include "tracking/landmark/square_refinement.hpp"
#include "tracking/planar/registry.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

struct TrackOptions {
  RunOptions run;
  RecordedOptions recorded;
  ArtificialChoice artificial;
  std::vector<std::string> trackers;
  std::vector<double> corners;
  double square_mm = 0;
  std::string truth;
};

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

int list_trackers() {
  for (const auto& engine : tracking::trackers().engines()) fmt::print("{:<24}{}\n", engine.name, engine.summary);
  return DONE;
}

/// What is tracked: a scene, a recording or an artificial sequence.
struct Tracked {
  sim::Scene scene;  ///< of an artificial sequence only the trackers' options
  std::unique_ptr<sim::Table> table;
  std::string config;
};

Tracked artificial(const TrackOptions& o) {
  if (!o.recorded.roi.empty() || !o.recorded.camera.empty() || o.recorded.frame_rate_hz > 0 || !o.corners.empty() ||
      !o.truth.empty() || o.square_mm > 0)
    throw ConfigError(
        "--roi, --corners, --camera, --frame-rate-hz, --square-mm and --truth are for recorded frames; "
        "an artificial sequence knows its region and truth");
  const sim::SequenceOptions options = sequence_for(o.artificial, o.run);
  Tracked tracked;
  tracked.table = sim::make_sequence_table(options);
  tracked.config = config_text(options, tracked.scene.tracking, "track");
  return tracked;
}

sim::Scene configure(const TrackOptions& o) {
  sim::Scene scene = scene_for(o.run, o.recorded);
  scene.show_tool = false;
  if (scene.settle_s >= scene.duration_s) scene.settle_s = 0;  // nothing is scored by time here
  sim::require_valid(scene, o.run.source);
  if (!scene.is_recorded() && (!o.corners.empty() || !o.truth.empty()))
    throw ConfigError("--corners and --truth are for recorded frames; a simulated scene knows both");
  if (!o.corners.empty() && !o.recorded.roi.empty()) throw ConfigError("give --roi or --corners, not both");
  if (o.square_mm > 0 && scene.is_recorded() && scene.camera.calibration.empty())
    throw ConfigError("--square-mm needs --camera FILE: without a calibration there are no millimetres");
  return scene;
}

bool are_pictures(const std::string& source) {
  return std::filesystem::is_directory(source) || source.find('%') != std::string::npos;
}

std::unique_ptr<tracking::TargetEstimator> estimator_for(const TrackOptions& o, const sim::Table& table) {
  tracking::EstimatorOptions options;
  options.camera = table.camera();
  options.side_m = o.square_mm > 0 ? 1e-3 * o.square_mm : table.region_side_m();
  return options.side_m > 0 ? tracking::estimators().make("landmark_refined", options) : nullptr;
}

// `truth` may be null.
Tracked opened(const TrackOptions& o, const CornerTruth* truth) {
  if (o.artificial) return artificial(o);
  sim::Scene scene = configure(o);
  // pictures carry no clock: where the command line gives none they run on that of their truth
  if (truth && o.recorded.frame_rate_hz == 0 && !is_scene(o.run.source) && are_pictures(o.run.source))
    scene.camera.frame_rate_hz = truth->frame_rate_hz();
  return {scene, sim::make_table(scene), config_text(scene, "track")};
}

tracking::Quad region_for(const TrackOptions& o, const sim::HandPicked& picked) {
  if (o.corners.empty()) return picked.target;
  tracking::Quad quad;
  for (std::size_t i = 0; i < 4; ++i) quad[i] = {o.corners[2 * i], o.corners[2 * i + 1]};
  return quad;
}

Report track_report(const nlohmann::json& summary, const std::vector<TrackLane>& lanes,
                    std::vector<ReportPicture> pictures, const std::string& config) {
  Report report;
  report.title = "track " + summary["source"].get<std::string>();
  const auto& first = summary["trackers"][0];
  const int lost = first["lost_frames"], frames = summary["frames"];
  report.headline = fmt::format("{} followed the region in {} of {} frames.", first["name"].get<std::string>(),
                                frames - lost, frames);
  report.headline_number = first["error_px"].is_null() ? std::to_string(lost) : number(first["error_px"]["mean"], 3);
  report.headline_unit = first["error_px"].is_null() ? "lost frames" : "px mean corner error";
  ReportTable table{
      "Trackers", {"tracker", "lost", "wrong OK", "uncertain", "error px", "std", "max", "ms p50", "ms p99"}, {}, ""};
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    const auto& lane = summary["trackers"][i];
    const auto error = [&](const char* key) {
      return lane["error_px"].is_null() ? "-" : number(lane["error_px"][key], 3);
    };
    table.rows.push_back({lanes[i].name(), std::to_string(lane["lost_frames"].get<int>()),
                          number(lane["wrong_ok_frames"], 0), std::to_string(lane["uncertain_frames"].get<int>()),
                          error("mean"), error("std"), error("max"), number(lane["ms"]["p50"], 3),
                          number(lane["ms"]["p99"], 3)});
    report.plots.push_back({"Displacement, " + lanes[i].name(),
                            "px",
                            {{"horizontal", "displacement/u_px"}, {"vertical", "displacement/v_px"}},
                            1,
                            "",
                            &lanes[i].table()});
    report.plots.push_back(
        {"Quality, " + lanes[i].name(), "", {{"quality", "track/quality"}}, 1, "", &lanes[i].table()});
  }
  report.tables = {table};
  report.pictures = std::move(pictures);
  report.table = &lanes.front().table();
  report.state_column = "track/state";
  report.config_yaml = config;
  report.summary = summary;
  return report;
}

int run_track(TrackOptions o) {
  if (o.run.list) return list_trackers();
  if (o.artificial) o.run.source = artificial_source(o.artificial, o.run);
  std::optional<CornerTruth> truth_file;
  if (!o.truth.empty()) truth_file.emplace(o.truth);
  const auto [scene, table, config] = opened(o, truth_file ? &*truth_file : nullptr);
  std::vector<std::string> names = o.trackers.empty() ? std::vector<std::string>{scene.engines.tracker} : o.trackers;
  if (names == std::vector<std::string>{"all"}) names = tracking::trackers().names();
  for (const auto& name : names) {
    tracking::trackers().require(name);
    if (std::count(names.begin(), names.end(), name) > 1)
      throw ConfigError(fmt::format("--tracker: '{}' is given twice; keep one", name));
  }
  const std::size_t expected = table->frames().frame_count().value_or(0);

  // Without a calibration the homography stays on the pixels: a guessed lens would only add its own error.
  const bool calibrated = !o.artificial && (!scene.is_recorded() || !scene.camera.calibration.empty());
  const tracking::Camera lens = calibrated ? table->camera() : tracking::Camera{};
  std::vector<TrackLane> lanes;
  for (const auto& name : names)
    lanes.emplace_back(name, tracking::trackers().make(name, lens, scene.tracking), estimator_for(o, *table),
                       rows_ahead(expected));
  tracking::Frame frame;
  if (!table->frames().next(frame)) throw InputError(o.run.source + ": there is no frame");
  const auto picked = table->picked();
  tracking::Quad region = region_for(o, picked);
  if (picked.target_edge_ratio > 0)
    region = tracking::refine_square(frame.grey, lens, region, picked.target_edge_ratio).corners;
  for (auto& lane : lanes)
    if (const std::string why = lane.start(frame, region); !why.empty())
      throw ConfigError(fmt::format("{}: the region cannot be tracked by {}: {}", o.run.source, lane.name(), why));

  RunFolder folder(run_path(o.run, "track"));
  std::vector<ReportPicture> pictures;
  std::size_t count = 0, with_truth = 0;
  bool interrupted = false;
  {
    const Interrupt interrupt;
    Progress progress("track " + stem_of(o.run.source), expected, o.run.quiet);
    do {
      servo::LoopRecord record;
      record.frame = frame;
      const auto truth = truth_file ? truth_file->at(frame.time_s) : table->truth(record).corners_px;
      with_truth += truth.has_value();
      cv::Mat canvas;
      const bool show = frame.status == tracking::FrameStatus::OK && (count == 0 || count == expected / 2);
      if (show) canvas = canvas_of(frame);
      for (auto& lane : lanes) {
        const tracking::Track& track = lane.follow(frame, truth ? &*truth : nullptr, now_s);
        if (show) draw_region(canvas, track);
      }
      if (show) pictures.push_back({fmt::format("{:.2f} s", frame.time_s), canvas});
      progress.update(++count);
    } while (!(interrupted = interrupt.requested()) && table->frames().next(frame));
  }

  nlohmann::json summary{{"command", "track"},
                         {"version", HEARTSERVO_VERSION},
                         {"source", o.run.source},
                         {"frames", count},
                         {"interrupted", interrupted}};
  for (const auto& lane : lanes) {
    summary["trackers"].push_back(lane.summary());
    lane.table().write_csv(folder.file(lanes.size() == 1 ? "frames.csv" : "frames_" + lane.name() + ".csv"));
    if (lane.table().has("pose/qw")) write_tum(lane.table(), folder.file("trajectory_" + lane.name() + ".tum"));
  }
  if (lanes.size() > 1) lanes.front().table().write_csv(folder.file("frames.csv"));
  finish_run(folder, track_report(summary, lanes, pictures, config), o.run, track_table(summary));
  if (truth_file && with_truth == 0)
    fmt::print(stderr, "heartservo: {}: no row has the time of a frame, so no error is known; check --frame-rate-hz\n",
               o.truth);
  return interrupted ? INTERRUPTED : DONE;
}

}  // namespace

Command add_track_command(CLI::App& program) {
  auto options = std::make_shared<TrackOptions>();
  TrackOptions& o = *options;
  CLI::App* app = program.add_subcommand("track", "follow a region; several trackers side by side");
  add_run_options(*app, o.run, "image folder, printf pattern, video or scene (.yaml)");
  add_recording_options(*app, o.recorded);
  add_artificial_options(*app, o.artificial);
  app->add_option("--tracker", o.trackers, "trackers, separated by commas, or 'all'")->delimiter(',');
  app->add_option("--corners", o.corners, "region as x1,y1,...,x4,y4 in px, clockwise from top left")
      ->delimiter(',')
      ->expected(8)
      ->check(finite(-1e5, 1e5));
  app->add_option("--square-mm", o.square_mm, "side of the square landmark: metric pose, with --camera")
      ->check(finite(0.1, 1000));
  app->add_option("--truth", o.truth, "CSV of the true corners, as 'heartservo render' writes it")->type_name("FILE");
  app->add_flag("--list", o.run.list, "list the trackers and exit");
  app->footer(
      "Examples:\n  heartservo track frames/ --roi 150,130,60,60\n"
      "  heartservo track scenes/pig_2007.yaml --tracker all --frames 250\n"
      "  heartservo track --artificial b --texture retina --side 40 --tracker all\n"
      "  heartservo track rendered/frames --truth rendered/truth.csv --corners 232,223,286,224,285,278,231,277");
  return {app, [options] { return run_track(*options); }};
}

}  // namespace heartservo::tools
