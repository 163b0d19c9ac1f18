// heartservo capture: lists and probes cameras, and records from one.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "tools/capture/capture_summary.hpp"
#include "tools/capture/device_list.hpp"
#include "tools/capture/picture_writer.hpp"
#include "tools/capture/probe.hpp"
#include "tools/capture/recorder.hpp"
#include "tools/command.hpp"
#include "tools/interrupt.hpp"
#include "tools/progress.hpp"
#include "tools/run_folder.hpp"
#include "tools/time_table.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/frames/recording.hpp"
#include "tracking/frames/v4l2/v4l2_camera.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;

struct CaptureOptions {
  RunOptions run;
  bool probe = false, png = false, grey = false;
  double seconds = 0;
};

int list_devices(const CaptureOptions& o) {
  const json devices = device_list();
  if (o.run.json)
    fmt::print("{}\n", json({{"command", "capture"}, {"devices", devices}}).dump(2));
  else
    fmt::print("{}", device_text(devices));
  return DONE;
}

int probe_device(const CaptureOptions& o, const tracking::v4l2::CameraOptions& camera) {
  const json probed = probe(camera, o.seconds > 0 ? o.seconds : 2);
  fmt::print("{}", o.run.json ? probed.dump(2) + "\n" : probe_text(probed));
  const auto& formats = probed["formats"];
  const bool none = std::all_of(formats.begin(), formats.end(), [](const json& f) { return f.contains("problem"); });
  return none ? DEVICE_TROUBLE : DONE;
}

/// What became of a recording.
struct Outcome {
  bool interrupted = false;  ///< Ctrl-C
  std::string failure;       ///< of the device
  std::string stopped;       ///< of the disk
  std::uint64_t written = 0, dropped = 0;
  std::size_t most_queued = 0;
};

// `frame`: the first.
Outcome record(const CaptureOptions& o, tracking::v4l2::V4l2Camera& camera, tracking::Frame frame, bool colour,
               Recorder& recorder) {
  Outcome outcome;
  const std::uint64_t most = o.run.frames ? static_cast<std::uint64_t>(*o.run.frames) : UINT64_MAX;
  const Interrupt interrupt;
  Progress progress("capture " + stem_of(camera.description()), o.run.frames ? static_cast<std::size_t>(most) : 0,
                    o.run.quiet);
  const double begin = frame.time_s;
  const auto keep = [&] {
    if (frame.grey.empty()) return false;  // of another size; an event says so
    if (!colour) frame.colour.release();
    if (colour && frame.colour.empty()) cv::cvtColor(frame.grey, frame.colour, cv::COLOR_GRAY2BGR);
    return recorder.offer(frame);
  };
  std::uint64_t taken = keep();
  while (taken < most && recorder.stopped().empty()) {
    if (interrupt.requested()) {
      outcome.interrupted = true;
      break;
    }
    if (o.seconds > 0 && camera.now_s() - begin >= o.seconds) break;
    if (!camera.wait_for(frame, 0.1)) {
      if (camera.ended()) {
        outcome.failure = camera.failure();
        break;
      }
      continue;
    }
    taken += keep();
    progress.update(taken);
  }
  recorder.finish();
  outcome.stopped = recorder.stopped();
  outcome.written = recorder.written();
  outcome.dropped = recorder.dropped();
  outcome.most_queued = recorder.most_queued();
  return outcome;
}

Report report_of(const json& summary, const TimeTable& table, const CaptureOptions& o) {
  Report report;
  report.title = "capture " + summary["device"].get<std::string>();
  const json& recorded = summary["recorded"];
  report.headline =
      fmt::format("{} frames recorded, {} dropped.", recorded["frames"].get<int>(), recorded["dropped"].get<int>());
  report.headline_number = fmt::format("{:.2f}", summary["measured"]["rate_hz"].get<double>());
  report.headline_unit = "Hz measured";
  if (recorded["stopped"].is_string()) report.notices.push_back(recorded["stopped"].get<std::string>());
  if (recorded["failure"].is_string()) report.notices.push_back(recorded["failure"].get<std::string>());
  if (table.rows() > 1)
    report.plots = {
        {"Interval between frames", "ms", {{"interval", "interval_s"}}, 1e3, "", nullptr},
        {"Age of a frame when it was ready", "ms", {{"age", "age_s"}}, 1e3, "From its time stamp.", nullptr}};
  report.tables = {capture_table(summary), event_table(summary)};
  report.table = &table;
  report.summary = summary;
  report.config_yaml = fmt::format("# heartservo {} capture\nsource: {}\npictures: {}\n", HEARTSERVO_VERSION,
                                   json(o.run.source).dump(), o.png ? "png" : "ffv1");
  return report;
}

TimeTable plotted(const std::filesystem::path& rows) {
  const TimeTable read = TimeTable::read_csv(rows);
  TimeTable table({"time_s", "interval_s", "age_s"}, read.rows());
  const auto time = read.time_s(), ready = read.column("capture/decoded_s");
  for (std::size_t i = 0; i < read.rows(); ++i)
    table.append({time[i], i > 0 ? time[i] - time[i - 1] : NAN, ready[i] - time[i]});
  return table;
}

int run_capture(const CaptureOptions& o) {
  if (o.run.list) return list_devices(o);
  if (o.run.source.empty())
    throw ConfigError(
        "DEVICE is missing: give for instance /dev/video0; 'heartservo capture --list' shows what there is");
  auto options = tracking::v4l2::parse_camera(o.run.source);
  if (o.probe) return probe_device(o, options);
  options.every_frame = true;
  const auto camera = tracking::v4l2::open_v4l2_camera(options, !o.grey);
  RunFolder folder(o.run.out.empty() ? default_run_path("capture", stem_of(options.device))
                                     : std::filesystem::path(o.run.out));
  tracking::Frame first;
  if (!camera->wait_for(first, 5)) throw DeviceError(options.device + ": no frame came");
  const bool colour = !o.grey && !first.colour.empty();
  const auto home = folder.file("frames.csv").parent_path();
  Recorder recorder(home, o.png ? write_pngs(home) : write_ffv1(home, camera->size(), colour, camera->frame_rate_hz()),
                    {});
  const Outcome outcome = record(o, *camera, first, colour, recorder);

  json summary = json_of(camera->report());
  const auto given = [](const std::string& text) { return text.empty() ? json() : json(text); };
  summary["command"] = "capture";
  summary["version"] = HEARTSERVO_VERSION;
  summary["recorded"] = {{"frames", outcome.written},
                         {"dropped", outcome.dropped},
                         {"most_queued", outcome.most_queued},
                         {"pictures", o.png ? tracking::RECORDED_PICTURES : tracking::RECORDED_VIDEO},
                         {"colour", colour},
                         {"interrupted", outcome.interrupted},
                         {"stopped", given(outcome.stopped)},
                         {"failure", given(outcome.failure)}};
  const TimeTable table = outcome.written > 0 ? plotted(folder.file("frames.csv")) : TimeTable({"time_s"});
  finish_run(folder, report_of(summary, table, o), o.run,
             fmt::format("{}\nrecorded    {} frames, {} dropped because the disk was too slow (at most {} waited)\n",
                         capture_text(summary), outcome.written, outcome.dropped, outcome.most_queued));
  const auto kept = fmt::format("the {} frames before are in {}", outcome.written, folder.path().string());
  if (!outcome.failure.empty()) throw DeviceError(fmt::format("{}; {}", outcome.failure, kept));
  if (!outcome.stopped.empty()) throw ConfigError(fmt::format("{}; {}", outcome.stopped, kept));
  return outcome.interrupted ? INTERRUPTED : DONE;
}

}  // namespace

Command add_capture_command(CLI::App& program) {
  auto options = std::make_shared<CaptureOptions>();
  CaptureOptions& o = *options;
  CLI::App* app = program.add_subcommand("capture", "record from a camera (V4L2); list and probe cameras");
  app->add_option("device", o.run.source, "/dev/video0, with options after it: /dev/video0,size=1280x720,rate=50");
  app->add_flag("--list", o.run.list, "list devices, inputs, formats, sizes and rates, and exit");
  app->add_flag("--probe", o.probe, "measure rate, jitter, gaps and age in every format, show the controls, and exit");
  app->add_option("--out", o.run.out, "folder of the recording (default: runs/capture-NAME-DATE)")->type_name("DIR");
  app->add_option("--frames", o.run.frames, "number of frames (default: until Ctrl-C)")
      ->check(CLI::Range(1, 2000000000));
  app->add_option("--seconds", o.seconds, "length of the recording, or of the probe in each format (2)")
      ->check(finite(0.1, 1e6));
  app->add_flag("--png", o.png, "a folder of PNGs instead of FFV1 in Matroska; both are without loss");
  app->add_flag("--grey", o.grey, "only the luma that trackers see");
  app->add_flag("--json", o.run.json, "print the summary, the list or the probe as JSON on stdout and nothing else");
  app->add_flag("--quiet", o.run.quiet, "no progress and no table");
  app->footer(
      "Examples:\n  heartservo capture --list\n"
      "  heartservo capture --probe DEVICE\n"
      "  heartservo capture DEVICE,input=HDMI,crop=round --out OPERATION --seconds 60\n\n" +
      tracking::v4l2::camera_option_help());
  return {app, [options] { return run_capture(*options); }};
}

}  // namespace heartservo::tools
