// heartservo stabilise: a video in which the followed region stands still, and how still it is.
#include <fmt/format.h>

#include <chrono>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "servo/loop/score.hpp"
#include "sim/table/stages.hpp"
#include "sim/table/table.hpp"
#include "tools/album.hpp"
#include "tools/command.hpp"
#include "tools/image_motion.hpp"
#include "tools/interrupt.hpp"
#include "tools/overlay.hpp"
#include "tools/progress.hpp"
#include "tools/run_folder.hpp"
#include "tools/servo_summary.hpp"
#include "tools/short_video.hpp"
#include "tracking/planar/registry.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/still/still_view.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;
using tracking::TrackState;

struct StabiliseOptions {
  RunOptions run;
  RecordedOptions recorded;
  std::string tracker;
};

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

sim::Scene configure(const StabiliseOptions& o) {
  sim::Scene scene = scene_for(o.run, o.recorded);
  if (!o.tracker.empty()) scene.engines.tracker = tracking::trackers().require(o.tracker).name;
  scene.show_tool = false;
  if (scene.settle_s >= scene.duration_s) scene.settle_s = 0;
  sim::require_valid(scene, o.run.source);
  return scene;
}

struct Run {
  TimeTable table{{"time_s", "track/state", "track/quality", "raw/u_px", "raw/v_px", "still/u_px", "still/v_px",
                   "timing/track_ms", "timing/still_ms"}};
  ImageMotion raw, still;
  std::size_t lost = 0;
  bool interrupted = false;
  explicit Run(const tracking::Quad& region) : raw(region), still(region) {}
};

cv::Mat bgr_of(const cv::Mat& picture) {
  if (picture.channels() == 3) return picture;
  cv::Mat bgr;
  cv::cvtColor(picture, bgr, cv::COLOR_GRAY2BGR);
  return bgr;
}

// Video of MJPEG pictures: every player opens it, and it needs no licence.
class Video {
 public:
  Video(const std::filesystem::path& file, double rate, cv::Size size)
      : name_(file.string()), writer_(name_, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), rate, size) {
    if (!writer_.isOpened()) throw ConfigError(name_ + ": the video cannot be written; check space and permissions");
  }
  void add(const cv::Mat& bgr) { writer_.write(bgr); }

 private:
  std::string name_;
  cv::VideoWriter writer_;
};

json summary_of(const StabiliseOptions& o, const sim::Scene& scene, const Run& run, double rate) {
  const double raw = run.raw.rms_px(), still = run.still.rms_px();
  const auto times = [&](const char* column) {
    const auto t = run.table.column(column);
    std::vector<double> v(t.begin(), t.end());
    return json{
        {"p50", servo::percentile(v, 50)}, {"p99", servo::percentile(v, 99)}, {"max", servo::percentile(v, 100)}};
  };
  return {{"command", "stabilise"},
          {"version", HEARTSERVO_VERSION},
          {"source", is_scene(o.run.source) ? stem_of(o.run.source) : o.run.source},
          {"seed", scene.seed},
          {"frames", run.table.rows()},
          {"frame_rate_hz", rate},
          {"tracker", scene.engines.tracker},
          {"interrupted", run.interrupted},
          {"lost_frames", run.lost},
          {"motion_px", {{"raw", raw}, {"still", still}}},
          {"reduction_percent", raw > 0 ? json(100 * (1 - still / raw)) : json()},
          {"timing", {{"track_ms", times("timing/track_ms")}, {"still_ms", times("timing/still_ms")}}}};
}

Report report_of(const json& j, const Run& run, std::vector<ReportPicture> pictures, const std::string& config) {
  Report report;
  report.title = "stabilise " + j["source"].get<std::string>();
  report.headline = fmt::format("The region moves by {} px RMS in the camera's picture and by {} px in the still one.",
                                number(j["motion_px"]["raw"], 2), number(j["motion_px"]["still"], 2));
  report.headline_number = number(j["reduction_percent"], 1);
  report.headline_unit = "% of the image motion removed";
  if (run.lost > 0) report.notices.push_back(fmt::format("The region was lost in {} frames.", run.lost));
  report.plots = {
      {"Place of the region, by optical flow from the first picture",
       "px",
       {{"raw u", "raw/u_px"}, {"raw v", "raw/v_px"}, {"still u", "still/u_px"}, {"still v", "still/v_px"}}},
      {"Computing time", "ms", {{"tracker", "timing/track_ms"}, {"still view", "timing/still_ms"}}}};
  report.pictures = std::move(pictures);
  report.tables = {{"Image motion of the region, RMS",
                    {"", "px"},
                    {{"raw", number(j["motion_px"]["raw"], 3)}, {"still", number(j["motion_px"]["still"], 3)}},
                    "By dense optical flow (DIS), independent of the tracker, around each pixel's mean place."}};
  report.table = &run.table;
  report.states = {{"tracking", "track/state"}};
  report.config_yaml = config;
  report.summary = j;
  return report;
}

int run_stabilise(const StabiliseOptions& o) {
  sim::Scene scene = configure(o);
  const auto table = sim::make_table(scene);
  const auto tracker = tracking::trackers().make(scene.engines.tracker, table->camera(), scene.tracking);
  tracking::FrameSource& frames = table->frames();
  tracking::Frame frame;
  if (!frames.next(frame)) throw InputError(o.run.source + ": there is no frame");
  const tracking::Quad region = table->picked().target;
  if (const std::string why = tracker->start(frame, region); !why.empty())
    throw ConfigError(fmt::format("{}: the region cannot be tracked: {}", o.run.source, why));

  const std::size_t expected = frames.frame_count().value_or(0);
  Run run(region);
  tracking::StillView view(region, frames.size());
  Album album(expected, [](double px) { return fmt::format("{:.2f} px from its place", px); });
  RunFolder folder(run_path(o.run, "stabilise"));
  ShortVideo film(folder.file("film.webm"), 0, frames.frame_rate_hz(), region, frames.size());
  Video video(folder.file("video.mkv"), frames.frame_rate_hz(), frames.size());
  {
    const Interrupt interrupt;
    Progress progress("stabilise " + stem_of(o.run.source), expected, o.run.quiet);
    do {
      const double begin = now_ms();
      const tracking::Track track = tracker->track(frame);
      const double tracked = now_ms();
      const cv::Mat& still = view.update(frame.colour.empty() ? frame.grey : frame.colour, *tracker, track);
      const double done = now_ms();
      run.lost += track.state == TrackState::LOST;
      cv::Mat grey = still;
      if (still.channels() == 3) cv::cvtColor(still, grey, cv::COLOR_BGR2GRAY);
      const Eigen::Vector2d raw = run.raw.add(frame.grey), left = run.still.add(grey);
      const cv::Mat bgr = bgr_of(still);
      video.add(bgr);
      if (film.wants(frame)) {
        cv::Mat drawn = canvas_of(frame);
        draw_region(drawn, track);
        film.add(frame, drawn, *tracker, track);
      }
      run.table.append({frame.time_s, static_cast<double>(track.state), track.quality, raw.x(), raw.y(), left.x(),
                        left.y(), tracked - begin, done - tracked});
      album.look_at({run.table.rows() - 1, frame.time_s, left.norm(), "", track.state == TrackState::LOST}, [&] {
        return ReportPicture{"", bgr.clone(), {}};
      });
      progress.update(run.table.rows());
    } while (!(run.interrupted = interrupt.requested()) && frames.next(frame));
  }
  const json j = summary_of(o, scene, run, frames.frame_rate_hz());
  run.table.write_csv(folder.file("frames.csv"));
  Report report = report_of(j, run, album.pictures(), config_text(scene, "stabilise"));
  if (!film.finish().is_null())
    report.video = {"The endoscope's picture, and the view in which the region stands still.",
                    folder.file("film.webm")};
  finish_run(
      folder, report, o.run,
      fmt::format("{}: {} frames, {}, lost {}\n\nimage motion of the region (RMS, optical flow)\n"
                  "  raw    {:>8} px\n  still  {:>8} px\n  removed {:>7} %\nstill view {} ms (p50), {} ms (p99)\n",
                  j["source"].get<std::string>(), run.table.rows(), scene.engines.tracker, run.lost,
                  number(j["motion_px"]["raw"], 3), number(j["motion_px"]["still"], 3),
                  number(j["reduction_percent"], 1), number(j["timing"]["still_ms"]["p50"], 2),
                  number(j["timing"]["still_ms"]["p99"], 2)));
  return run.interrupted ? INTERRUPTED : DONE;
}

}  // namespace

Command add_stabilise_command(CLI::App& program) {
  auto options = std::make_shared<StabiliseOptions>();
  StabiliseOptions& o = *options;
  CLI::App* app = program.add_subcommand("stabilise", "write the view in which the region stands still, and how still");
  add_run_options(*app, o.run, "scene (.yaml), image folder, printf pattern or video");
  add_recording_options(*app, o.recorded);
  app->add_option("--tracker", o.tracker, "overrides the scene's tracker");
  app->footer(
      "Examples:\n  heartservo stabilise scenes/pig_2007.yaml\n"
      "  heartservo stabilise recorded/frames --roi 150,130,60,60 --frame-rate-hz 25 --tracker deformable");
  return {app, [options] { return run_stabilise(*options); }};
}

}  // namespace heartservo::tools
