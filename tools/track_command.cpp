// heartservo track: follows a region with one or several trackers side by side.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "servo/loop/loop_record.hpp"
#include "sim/sequence/sequence_table.hpp"
#include "sim/table/stages.hpp"
#include "sim/table/table.hpp"
#include "tools/artificial.hpp"
#include "tools/capture/capture_summary.hpp"
#include "tools/command.hpp"
#include "tools/corner_truth.hpp"
#include "tools/depth_rail.hpp"
#include "tools/interrupt.hpp"
#include "tools/overlay.hpp"
#include "tools/progress.hpp"
#include "tools/report/report.hpp"
#include "tools/run_folder.hpp"
#include "tools/track_pictures.hpp"
#include "tools/track_report.hpp"
#include "tools/track_run.hpp"
#include "tools/track_tables.hpp"
#include "tools/track_truth.hpp"
#include "tools/track_view.hpp"
#include "tools/trajectory.hpp"
#include "tools/window/selection.hpp"
#include "tracking/frames/picture_file.hpp"
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
  std::string truth, points, point;
  std::string estimator, landmark;
  bool show = false, select = false;
  int igtl_port = 0;
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
  std::string points, point;  ///< file of annotated points, and which of them; "" for none
  std::optional<sim::SequenceOptions> sequence;
};

Tracked artificial(const TrackOptions& o) {
  if (!o.recorded.roi.empty() || !o.recorded.camera.empty() || o.recorded.frame_rate_hz > 0 || !o.corners.empty() ||
      !o.truth.empty() || !o.points.empty() || !o.point.empty() || o.square_mm > 0 || !o.recorded.right.empty() ||
      !o.estimator.empty() || !o.landmark.empty())
    throw ConfigError(
        "--roi, --corners, --camera, --stereo, --frame-rate-hz, --square-mm, --estimator, --landmark, --truth, "
        "--points and --point are for recorded frames; an artificial sequence knows its region and truth");
  const sim::SequenceOptions options = sequence_for(o.artificial, o.run);
  Tracked tracked;
  tracked.table = sim::make_sequence_table(options);
  tracked.config = config_text(options, tracked.scene.tracking, "track");
  tracked.sequence = options;
  return tracked;
}

sim::Scene configure(const TrackOptions& o) {
  sim::Scene scene = scene_for(o.run, o.recorded);
  scene.show_tool = false;
  if (scene.settle_s >= scene.duration_s) scene.settle_s = 0;  // nothing is scored by time here
  sim::require_valid(scene, o.run.source);
  if (!scene.is_recorded() && (!o.corners.empty() || !o.truth.empty() || !o.points.empty() || !o.point.empty()))
    throw ConfigError("--corners, --truth, --points and --point are for recorded frames; a simulated scene knows them");
  if (!o.point.empty() && o.points.empty() && scene.recording.reference.empty())
    throw ConfigError(fmt::format("--point {} needs --points FILE, which has the point", o.point));
  if (!o.corners.empty() && !o.recorded.roi.empty()) throw ConfigError("give --roi or --corners, not both");
  if (o.square_mm > 0 && scene.is_recorded() && scene.camera.calibration.empty())
    throw ConfigError("--square-mm needs --camera FILE: without a calibration there are no millimetres");
  return scene;
}

bool are_pictures(const std::string& source) {
  return std::filesystem::is_directory(source) || source.find('%') != std::string::npos;
}

// The landmark's picture of the command line; empty without one.
cv::Mat printed_plate(const TrackOptions& o) {
  if (o.landmark.empty()) return {};
  if (o.estimator != "landmark_dense") throw ConfigError("--landmark is for --estimator landmark_dense");
  const auto picture = tracking::read_picture(o.landmark);
  if (!picture.problem.empty()) throw InputError(picture.problem);
  return picture.grey;
}

std::unique_ptr<tracking::TargetEstimator> estimator_for(const TrackOptions& o, const Tracked& tracked,
                                                         std::size_t region) {
  const sim::Table& table = *tracked.table;
  const std::string& of_scene = tracked.scene.engines.estimator;
  const bool of_depth = of_scene == "region_depth" || of_scene == "stereo_depth";
  if (of_depth && !o.artificial && o.square_mm == 0 && o.estimator.empty())
    return tracking::estimators().make(of_scene, sim::estimator_options(tracked.scene, table, region));
  tracking::EstimatorOptions options;
  options.camera = table.camera();
  options.side_m = o.square_mm > 0 ? 1e-3 * o.square_mm : table.region_side_m(region);
  options.plate = o.landmark.empty() ? table.picked(region).target_plate : printed_plate(o);
  if (!(options.side_m > 0)) {
    if (!o.estimator.empty()) throw ConfigError("--estimator needs --square-mm, the side of the landmark");
    return nullptr;
  }
  if (!o.estimator.empty() && !o.estimator.starts_with("landmark_"))
    throw ConfigError(fmt::format("--estimator {}: here choose one of landmark_*", o.estimator));
  std::string name = o.estimator;
  if (name.empty()) name = of_scene.starts_with("landmark_") ? of_scene : "landmark_refined";
  return tracking::estimators().make(name, options);
}

// Regions to follow: those of --corners or --roi, else the scene's.
std::size_t region_count(const TrackOptions& o, const Tracked& tracked) {
  if (o.artificial) return 1;
  return o.corners.empty() ? tracked.scene.region_count() : o.corners.size() / 8;
}

// `truth` may be null.
Tracked opened(const TrackOptions& o, const CornerTruth* truth) {
  if (!o.estimator.empty()) tracking::estimators().require(o.estimator);
  (void)printed_plate(o);  // throws before anything is opened
  if (o.artificial) return artificial(o);
  sim::Scene scene = configure(o);
  // pictures carry no clock: where the command line gives none they run on that of their truth
  if (truth && o.recorded.frame_rate_hz == 0 && !is_scene(o.run.source) && are_pictures(o.run.source))
    scene.camera.frame_rate_hz = truth->frame_rate_hz();
  const std::string config = config_text(scene, "track");
  Tracked tracked{scene, nullptr, config, o.points, o.point, {}};
  if (o.points.empty() && !scene.recording.reference.empty()) {
    tracked.points = sim::resolve(scene, scene.recording.reference);
    if (o.point.empty()) tracked.point = scene.recording.point;
  }
  // the score of this command is its own, and so may be the region
  scene.recording.reference.clear();
  tracked.table = sim::make_table(scene);
  return tracked;
}

tracking::Quad region_for(const TrackOptions& o, const sim::HandPicked& picked, std::size_t region) {
  if (o.corners.empty()) return picked.target;
  tracking::Quad quad;
  for (std::size_t i = 0; i < 4; ++i) quad[i] = {o.corners[8 * region + 2 * i], o.corners[8 * region + 2 * i + 1]};
  return quad;
}

std::vector<std::string> chosen_trackers(const TrackOptions& o, const sim::Scene& scene) {
  auto names = o.trackers.empty() ? std::vector<std::string>{scene.engines.tracker} : o.trackers;
  if (names == std::vector<std::string>{"all"}) names = tracking::trackers().names();
  for (const auto& name : names) {
    tracking::trackers().require(name);
    if (std::count(names.begin(), names.end(), name) > 1)
      throw ConfigError(fmt::format("--tracker: '{}' is given twice; keep one", name));
  }
  return names;
}

// The region and its centre; the point to score comes with the truth.
TrackStart start_of(const TrackOptions& o, const sim::HandPicked& picked, const tracking::Frame& frame,
                    const tracking::Camera& lens, std::size_t region, std::size_t regions) {
  TrackStart start{region_for(o, picked, region), {}};
  if (regions > 1) start.number = region + 1;
  if (picked.target_edge_ratio > 0)
    start.region = tracking::refine_square(frame.grey, lens, start.region, picked.target_edge_ratio).corners;
  if (!tracking::is_convex(start.region))
    throw ConfigError(o.run.source + ": the region's corners are not four points clockwise from top left");
  start.centre = region_centre(start.region, lens);
  return start;
}

// `truth` may be null; else it must outlive the result.
TruthSource source_of_truth(const TrackOptions& o, const Tracked& tracked, const CornerTruth* truth,
                            const tracking::Quad& region, std::size_t number) {
  TruthSource source = truth ? truth_of(*truth, o.truth) : truth_of(*tracked.table, number);
  if (!tracked.points.empty())
    add_point(source, tracked.points, sim::PointTracks::read(tracked.points).choose(tracked.point, region));
  return source;
}

// "esm"; where there are several regions "region2", and of several trackers "region2_esm".
std::string lane_name(const TrackStart& start, const std::string& tracker, bool several_trackers) {
  if (start.number == 0) return tracker;
  return fmt::format("region{}{}", start.number, several_trackers ? "_" + tracker : "");
}

void start_lanes(const TrackOptions& o, const Tracked& tracked, const tracking::Camera& lens, const TruthKind& truth,
                 const tracking::Frame& frame, const TrackStart& start, std::vector<TrackLane>& lanes) {
  const auto trackers = chosen_trackers(o, tracked.scene);
  for (const auto& name : trackers) {
    lanes.emplace_back(lane_name(start, name, trackers.size() > 1),
                       tracking::trackers().make(name, lens, tracked.scene.tracking),
                       estimator_for(o, tracked, start.number > 0 ? start.number - 1 : 0), truth,
                       rows_ahead(tracked.table->frames().frame_count().value_or(0)), tracked.table->frames().live());
    if (const std::string why = lanes.back().start(frame, start); !why.empty())
      throw ConfigError(fmt::format("{}: {} cannot be tracked by {}: {}", o.run.source,
                                    start.number > 0 ? fmt::format("region {}", start.number) : "the region", name,
                                    why));
  }
}

std::vector<PaperTable> paper_tables(const Tracked& tracked, const nlohmann::json& trackers) {
  if (!tracked.sequence) return {};
  if (tracked.sequence->sequence == "table5")
    return {paper_table_5(trackers, tracked.sequence->noise_grey, tracked.sequence->speculars)};
  if (tracked.sequence->sequence == "circle") return {paper_figure_7(trackers, tracked.sequence->speculars)};
  return {};
}

void write_tables(const RunFolder& folder, const std::vector<TrackLane>& lanes) {
  for (const auto& lane : lanes) {
    if (lanes.size() > 1) lane.table().write_csv(folder.file("frames_" + lane.name() + ".csv"));
    if (lane.table().has("pose/qw")) write_tum(lane.table(), folder.file("trajectory_" + lane.name() + ".tum"));
  }
  lanes.front().table().write_csv(folder.file("frames.csv"));
}

// The experiment of the scene, if it has one.
std::optional<sim::Scene> depth_rail_of(const TrackOptions& o) {
  if (o.artificial || o.run.source.empty() || !is_scene(o.run.source)) return {};
  sim::Scene scene = configure(o);
  if (scene.depth_rail.tilts_rad.empty()) return {};
  if (o.trackers.size() > 1 || !o.estimator.empty())
    throw ConfigError("the depth experiment compares its own estimators, with one tracker: give one, no --estimator");
  if (!o.trackers.empty()) scene.engines.tracker = chosen_trackers(o, scene).front();
  return scene;
}

// The first region anew, in all its lanes.
std::string relearn(const TrackOptions& o, const Tracked& tracked, const tracking::Camera& lens,
                    const tracking::Frame& frame, const tracking::Quad& region, std::vector<TrackLane>& lanes) {
  const auto names = chosen_trackers(o, tracked.scene);
  for (std::size_t i = 0; i < names.size(); ++i) {
    TrackStart start = lanes[i].began();
    start.region = region;
    start.point = start.centre = region_centre(region, lens);
    std::string why = lanes[i].restart(tracking::trackers().make(names[i], lens, tracked.scene.tracking),
                                       estimator_for(o, tracked, 0), frame, start);
    if (!why.empty()) return why;
  }
  return "";
}

int run_track(TrackOptions o) {
  if (o.run.list) return list_trackers();
  if (const auto scene = depth_rail_of(o)) return run_depth_rail(o.run, *scene);
  if (o.artificial) o.run.source = artificial_source(o.artificial, o.run);
  std::optional<CornerTruth> truth_file;
  if (!o.truth.empty()) truth_file.emplace(o.truth);
  const CornerTruth* truth = truth_file ? &*truth_file : nullptr;
  const Tracked tracked = opened(o, truth);
  const auto names = chosen_trackers(o, tracked.scene);  // throws before anything is read
  const bool threaded =
      std::none_of(names.begin(), names.end(), [](const auto& name) { return name.starts_with("visp_"); });
  tracking::FrameSource& frames = tracked.table->frames();
  // Without a calibration the homography stays on the pixels: a guessed lens would only add its own error.
  const bool calibrated = !o.artificial && (!tracked.scene.is_recorded() || !tracked.scene.camera.calibration.empty());
  const tracking::Camera lens = calibrated ? tracked.table->camera() : tracking::Camera{};
  tracking::Frame frame;
  if (!frames.next(frame)) throw InputError(o.run.source + ": there is no frame");
  TrackView view(o.show || o.select, o.igtl_port, o.run.source, frames);
  nlohmann::json selections = nlohmann::json::array();
  if (o.select) {
    const tracking::Quad region = selected_region(*view.window(), &frame, o.run.source);
    o.corners.clear();
    for (const auto& corner : region) o.corners.insert(o.corners.end(), {corner.x(), corner.y()});
    note_selection(selections, frame, region);
  }
  const std::size_t regions = region_count(o, tracked);
  if (regions > 1 && (truth || !tracked.points.empty()))
    throw ConfigError("--truth and --points score one region; give one --roi or --corners");
  std::vector<TruthSource> sources;
  std::vector<TrackLane> lanes;
  for (std::size_t i = 0; i < regions; ++i) {
    TrackStart start = start_of(o, tracked.table->picked(i), frame, lens, i, regions);
    sources.push_back(source_of_truth(o, tracked, truth, start.region, i));
    if (sources[i].kind.point) start.point = sources[i].at(frame).point;
    if (!start.point.allFinite()) start.point = start.centre;
    start_lanes(o, tracked, lens, sources[i].kind, frame, start, lanes);
  }
  const TruthSource& source = sources.front();

  RunFolder folder(run_path(o.run, "track"));
  const std::size_t expected = frames.frame_count().value_or(0);
  TrackAlbum album(expected, source.kind, frame);
  std::size_t count = 0, with_truth = 0;
  std::vector<TrackTruth> truths(regions);
  bool interrupted = false;
  {
    const Interrupt interrupt;
    Progress progress("track " + stem_of(o.run.source), expected, o.run.quiet);
    do {
      for (std::size_t i = 0; i < regions; ++i) truths[i] = sources[i].at(frame);
      follow_all(frame, truths, threaded, now_s, lanes);
      const TrackTruth& known = truths.front();
      with_truth += known.corners.has_value() || known.point.allFinite();
      album.look_at(frame, lanes, known);
      progress.update(++count);
      interrupted = view.attend(
          frame, lanes, selections, [&] { return interrupt.requested(); },
          [&](const tracking::Quad& region) { return relearn(o, tracked, lens, frame, region, lanes); });
    } while (!(interrupted |= interrupt.requested()) && frames.next(frame));
  }

  nlohmann::json summary{{"command", "track"}, {"version", HEARTSERVO_VERSION}, {"source", o.run.source},
                         {"frames", count},    {"interrupted", interrupted},    {"reference", nullptr},
                         {"point", nullptr}};
  if (!selections.empty()) summary["selections"] = selections;
  if (!source.reference.empty()) summary["reference"] = source.reference;
  if (source.kind.point) summary["point"] = *source.kind.point;
  for (const auto& lane : lanes) summary["trackers"].push_back(lane.summary());
  tracking::LiveSource* live = frames.live();
  if (live) summary["capture"] = json_of(live->report());
  std::string text =
      fmt::format("{}: {} frames\n\n{}", o.run.source, count, terminal_text(tracker_table(summary), false));
  std::vector<ReportTable> paper;
  for (const auto& compared : paper_tables(tracked, summary["trackers"])) {
    paper.push_back(compared.table);
    summary["paper"].push_back(compared.summary);
    text += fmt::format("\n{}\n\n{}", compared.table.title, terminal_text(compared.table, true));
  }
  write_tables(folder, lanes);
  const TimeTable plotted = side_by_side(lanes);
  if (live) text += "\n" + capture_text(summary["capture"]);
  finish_run(folder, track_report(summary, plotted, paper, album.pictures(lanes), tracked.config), o.run, text);
  if (!source.reference.empty() && with_truth == 0)
    fmt::print(stderr, "heartservo: {}: no row has the time of a frame, so no error is known; check --frame-rate-hz\n",
               source.reference);
  if (live && !live->failure().empty())
    throw DeviceError(fmt::format("{}; the frames before are in {}", live->failure(), folder.path().string()));
  return interrupted ? INTERRUPTED : DONE;
}

}  // namespace

Command add_track_command(CLI::App& program) {
  auto options = std::make_shared<TrackOptions>();
  TrackOptions& o = *options;
  CLI::App* app = program.add_subcommand("track", "follow a region; several trackers side by side");
  add_run_options(*app, o.run, "image folder, printf pattern, video, recording, v4l2:/dev/video0 or scene (.yaml)");
  add_recording_options(*app, o.recorded, true);
  add_artificial_options(*app, o.artificial);
  app->add_option("--tracker", o.trackers, "trackers, separated by commas, or 'all'")->delimiter(',');
  add_repeatable(*app, "--corners", o.corners, 8,
                 "region as x1,y1,...,x4,y4 in px, clockwise from top left; again for further regions");
  app->add_option("--square-mm", o.square_mm, "side of the square landmark: metric pose, with --camera")
      ->check(finite(0.1, 1000));
  app->add_option("--estimator", o.estimator,
                  "metric pose by landmark_refined (default), landmark_dense, landmark_linear or landmark_visp");
  app->add_option("--landmark", o.landmark,
                  "picture of the landmark as printed, cut at its outline, for landmark_dense; without it the first "
                  "frames show it")
      ->type_name("FILE");
  app->add_option("--truth", o.truth, "CSV of the true corners, as 'heartservo render' writes it")->type_name("FILE");
  app->add_option("--points", o.points,
                  "CSV of annotated points (frame or time_s, point, u_px, v_px, visible), to score")
      ->type_name("FILE");
  app->add_option("--point", o.point, "which of them; default: the one inside the region nearest to its centre")
      ->type_name("NAME");
  app->add_flag("--show", o.show, "a window with picture, region and numbers; keys: space pause, r learn anew, q end");
  app->add_flag("--select", o.select, "the same, and the region's four corners are clicked in the first frame");
  app->add_option("--igtl", o.igtl_port, "send target (with a metric pose) and picture to OpenIGTLink clients (18944)")
      ->check(CLI::Range(1, 65535))
      ->type_name("PORT");
  app->add_flag("--list", o.run.list, "list the trackers and exit");
  app->footer(
      "Examples:\n  heartservo track frames/ --roi 150,130,60,60\n"
      "  heartservo track scenes/pig_2007.yaml --tracker all --frames 250\n"
      "  heartservo track --artificial b --texture retina --side 40 --tracker all\n"
      "  heartservo track frames/ --roi 212,130,50,50 --points POINTS.csv --tracker all\n"
      "  heartservo track frames/ --roi 212,130,50,50 --roi 150,200,50,50\n"
      "  heartservo track LEFT --stereo RIGHT --camera STEREO.yaml --roi 150,130,60,60\n"
      "  heartservo track rendered/frames --truth rendered/truth.csv --corners 232,223,286,224,285,278,231,277");
  return {app, [options] { return run_track(*options); }};
}

}  // namespace heartservo::tools
