#include "tools/servo_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <optional>

#include "servo/loop/loop.hpp"
#include "servo/loop/score.hpp"
#include "servo/safety/run_checks.hpp"
#include "sim/table/stages.hpp"
#include "sim/table/table.hpp"
#include "tools/album.hpp"
#include "tools/capture/capture_summary.hpp"
#include "tools/capture/live_timing.hpp"
#include "tools/capture/real_time.hpp"
#include "tools/command.hpp"
#include "tools/igtl/igtl_stream.hpp"
#include "tools/interrupt.hpp"
#include "tools/loop_table.hpp"
#include "tools/overlay.hpp"
#include "tools/progress.hpp"
#include "tools/servo_summary.hpp"
#include "tools/servo_view.hpp"
#include "tools/short_video.hpp"
#include "tools/window/selection.hpp"
#include "tracking/frames/live_source.hpp"
#include "tracking/frames/peeked_source.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;

constexpr double kMostUnscored = 0.9;  // share of a run that may be spent on settling

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void refuse_hopeless(const servo::LoopOptions& options, const sim::Scene& scene, const servo::ToolRobot& robot) {
  const auto reasons = servo::reasons_to_refuse(options, scene.engines.controller, robot.data());
  if (!reasons.empty()) throw ConfigError(fmt::format("the run is refused: {}", fmt::join(reasons, "; ")));
}

std::string film_caption(const json& still) {
  return fmt::format(
      "From {:.1f} s on: the endoscope's picture (ring: goal, cross: tip), and the view in which the region stands "
      "still. By "
      "optical flow the region moves by {} px RMS on the left and by {} px on the right.",
      still["from_s"].get<double>(), number(still["raw_px"], 2), number(still["still_px"], 2));
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

void publish(IgtlStream& stream, const servo::LoopRecord& r) {
  IgtlSnapshot snapshot;
  snapshot.time_s = r.frame.time_s;
  snapshot.has_target = r.target.state != tracking::TrackState::LOST;
  snapshot.T_camera_target = r.target.T_camera_target;
  snapshot.T_camera_tip.translation() = r.tip;
  snapshot.grey = r.frame.grey;
  stream.publish(snapshot);
}

using Recording = std::unique_ptr<tracking::FrameSource>;

// Selects the region of a recording before anything is made for it: the virtual tool begins beside the region.
tracking::Quad select_in(Recording& opened, std::optional<LiveWindow>& window, ServoRequest& request) {
  auto source = std::make_unique<tracking::PeekedSource>(sim::open_recording(request.scene));
  window.emplace("heartservo: " + request.source, source->size(), !source->live());
  const tracking::Quad region = selected_region(*window, source->first(), request.source);
  Eigen::AlignedBox2d box;
  for (const auto& corner : region) box.extend(corner);
  request.scene.recording.roi = {box.min().x(), box.min().y(), box.sizes().x(), box.sizes().y()};
  opened = std::move(source);
  return region;
}

// Shows the frame and does what keys and mouse ask for; true: the run is to end.
bool attend(LiveWindow& window, WindowView view, servo::Loop& loop, const servo::LoopRecord& record,
            const std::function<servo::LoopStages()>& fresh, const LiveWindow::Stop& stop, nlohmann::json& selections) {
  for (;;) {
    window.show(view);
    const WindowState::Asked asked = window.attend(stop);
    if (asked.quit || !(asked.relearn || asked.region)) return asked.quit;
    const tracking::Quad region = asked.region ? *asked.region : record.track.corners;
    if (const std::string why = loop.restart(fresh(), region); !why.empty()) {
      view.lines.back() = "Not learnt: " + why;
      continue;
    }
    note_selection(selections, record.frame, region);
    view.regions.front().track.corners = region;
    view.regions.front().track.state = tracking::TrackState::OK;
  }
}

}  // namespace

void fit_settling(ServoRequest& request, std::size_t frames, double frame_rate_hz) {
  sim::Scene& scene = request.scene;
  const double last_s = frames == 0 ? 0 : static_cast<double>(frames - 1) / frame_rate_hz;
  if (request.settle_s >= 0 && request.settle_s > last_s)
    throw ConfigError(
        fmt::format("--settle-s {} leaves nothing to score: the last frame is at {:.3g} s", request.settle_s, last_s));
  if (request.settle_s >= 0 || scene.settle_s <= kMostUnscored * last_s) return;
  if (!request.quiet && scene.settle_s > 0)
    fmt::print(stderr, "heartservo: the run ends at {:.3g} s, too soon for settle_s ({} s): scored from {:.3g} s on\n",
               last_s, scene.settle_s, 0.5 * last_s);
  scene.settle_s = 0.5 * last_s;
}

ServoOutcome run_loop(ServoRequest request) {
  sim::Scene& scene = request.scene;
  const RealTime real_time(request.real_time);  // before the table: a camera's thread inherits it
  std::optional<LiveWindow> window;
  std::optional<tracking::Quad> selected;
  Recording opened;
  if (request.select && scene.is_recorded()) selected = select_in(opened, window, request);
  const auto table = sim::make_table(scene, std::move(opened));
  tracking::LiveSource* live = table->frames().live();
  if (request.real_time && !live) throw ConfigError("--real-time is for a camera: servo v4l2:/dev/video0");
  const servo::LoopOptions loop_options = sim::loop_options(scene, *table);
  refuse_hopeless(loop_options, scene, table->robot());
  servo::LoopStages stages = sim::make_stages(scene, *table);
  servo::Loop loop(table->frames(), table->robot(), std::move(stages), loop_options, table->marker_to_tip(), now_s);
  auto picked = table->picked();
  if (request.show && !window) window.emplace("heartservo: " + request.source, table->frames().size(), !live);
  if (request.select && !selected) selected = selected_region(*window, loop.first_frame(), request.source);
  if (selected) picked.target = *selected;
  if (const std::string why = loop.start(picked.target, picked.marker); !why.empty())
    throw ConfigError(fmt::format("{}: the region cannot be tracked: {}", request.source, why));

  const std::size_t expected = table->frames().frame_count().value_or(0);
  if (scene.is_recorded() && expected > 0) fit_settling(request, expected, loop_options.frame_rate_hz);
  std::filesystem::path film;
  if (request.before_run) film = request.before_run();
  ServoOutcome outcome;
  outcome.frames = make_loop_table(rows_ahead(expected), live != nullptr);
  LiveTiming live_timing(loop_options.frame_rate_hz, rows_ahead(expected));
  servo::Score score(scene.settle_s, 1 / loop_options.frame_rate_hz);
  score.reserve(rows_ahead(expected));
  Album album(expected, [](double px) { return fmt::format("{:.1f} px from the goal", px); });
  std::optional<ShortVideo> video;
  std::optional<IgtlStream> igtl;
  if (request.igtl_port > 0) igtl.emplace(request.igtl_port);
  const double latency_s = loop_options.latency.total_s();
  ServoRunFacts facts;
  json selections = json::array();
  if (selected) note_selection(selections, *loop.first_frame(), *selected);
  const std::size_t at_start = selections.size();
  double looped_s = 0;  // in the loop itself: not what is made for people to look at
  {
    const Interrupt interrupt;
    Progress progress(request.label, expected, request.quiet || request.real_time);
    servo::LoopRecord record;
    const auto step = [&] {
      const double begin = now_s();
      const bool more = loop.step(record);
      looped_s += now_s() - begin;
      return more;
    };
    while (!(facts.interrupted = interrupt.requested()) && step()) {
      if (igtl) publish(*igtl, record);
      const servo::TruthSample truth = table->truth(record);
      score.add(record, truth);
      append(outcome.frames, record, truth);
      if (live) live_timing.add(record, now_s());
      if (!request.real_time && request.pictures) {
        const double off_px = record.frame.time_s < scene.settle_s ? NAN : (truth.tip_px - truth.goal_px).norm();
        if (record.frame.status == tracking::FrameStatus::OK)
          album.look_at({outcome.frames.rows() - 1, record.frame.time_s, off_px, "",
                         record.track.state == tracking::TrackState::LOST},
                        [&] { return overlay(record, truth, loop.target_tracker()); });
        const bool same_region = selections.size() == at_start;  // the still view is that of one
        if (!film.empty() && !video && same_region)
          video.emplace(film, scene.settle_s, loop_options.frame_rate_hz, picked.target, record.frame.grey.size());
        if (video && same_region && video->wants(record.frame))
          video->add(record.frame, overlay(record, truth, loop.target_tracker()).bgr, loop.target_tracker(),
                     record.track);
        progress.update(outcome.frames.rows());
      }
      if (window &&
          attend(
              *window, servo_view(record, truth, table->camera(), table->reference(), latency_s), loop, record,
              [&] { return sim::make_stages(scene, *table); }, [&] { return interrupt.requested(); }, selections)) {
        facts.interrupted = true;
        break;
      }
    }
  }
  facts.scene = is_scene(request.source) ? stem_of(request.source) : request.source;
  facts.reference = table->reference();
  facts.reference_point = table->reference_point();
  facts.camera = scene.camera.calibration.empty() ? "assumed pinhole" : scene.camera.calibration;
  facts.frame_rate_hz = loop_options.frame_rate_hz;
  facts.stop_reason = loop.stop_reason();
  facts.real_time_factor =
      static_cast<double>(outcome.frames.rows()) / loop_options.frame_rate_hz / std::max(1e-9, looped_s);
  outcome.summary = servo_summary(score.summary(), scene, facts);
  if (live) {
    outcome.summary["capture"] = json_of(live->report());
    outcome.summary["live"] = live_timing.summary();
    outcome.summary["live"]["real_time"] = real_time.granted();
    outcome.device_failure = live->failure();
  }
  if (!selections.empty()) outcome.summary["selections"] = selections;
  if (video) outcome.summary["still_view"] = video->finish();
  if (video && !outcome.summary["still_view"].is_null())
    outcome.video = {film_caption(outcome.summary["still_view"]), film};
  outcome.pictures = album.pictures();
  outcome.stop_reason = facts.stop_reason;
  outcome.interrupted = facts.interrupted;
  outcome.scene = scene;
  return outcome;
}

}  // namespace heartservo::tools
