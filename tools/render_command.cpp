// heartservo render: writes the frames and truth of a scene or an artificial sequence, for other programs and for tests
// of trackers.
#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>

#include "servo/loop/loop_record.hpp"
#include "sim/sequence/sequence_table.hpp"
#include "sim/table/table.hpp"
#include "tools/artificial.hpp"
#include "tools/command.hpp"
#include "tools/corner_truth.hpp"
#include "tools/interrupt.hpp"
#include "tools/progress.hpp"
#include "tools/report/report.hpp"
#include "tools/run_folder.hpp"
#include "tools/track_truth.hpp"
#include "tracking/camera/camera_file.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

struct RenderOptions {
  RunOptions run;
  ArtificialChoice artificial;
  bool with_tool = false;
};

/// What is rendered, be it a scene or an artificial sequence.
struct Rendering {
  std::unique_ptr<sim::Table> table;
  std::string title, config;
  nlohmann::json facts;  ///< its entries in summary.json
  bool metric = true;    ///< has a camera and a place in space
};

void write_png(const std::filesystem::path& file, const cv::Mat& grey) {
  bool written = false;
  try {
    written = cv::imwrite(file.string(), grey, {cv::IMWRITE_PNG_COMPRESSION, 1});
  } catch (const cv::Exception&) {
  }
  if (!written) throw ConfigError(file.string() + ": cannot be written; check space and permissions");
}

Rendering scene_rendering(const RenderOptions& o) {
  if (o.run.source.empty() || !is_scene(o.run.source))
    throw ConfigError("SCENE is missing: give a scene file such as scenes/pig_2007.yaml, or --artificial NAME");
  sim::Scene scene = scene_for(o.run, {});
  if (scene.is_recorded()) throw ConfigError(o.run.source + ": frames from disk need no rendering");
  scene.show_tool = o.with_tool;
  if (scene.settle_s >= scene.duration_s) scene.settle_s = 0;
  sim::require_valid(scene, o.run.source);
  return {sim::make_table(scene),
          scene.title,
          config_text(scene, "render"),
          {{"scene", stem_of(o.run.source)}, {"seed", scene.seed}}};
}

Rendering artificial_rendering(const RenderOptions& o) {
  if (o.with_tool) throw ConfigError("--with-tool is for scenes; an artificial sequence has no tool");
  const sim::SequenceOptions options = sequence_for(o.artificial, o.run);
  Rendering r{sim::make_sequence_table(options), "", config_text(options, {}, "render"), {}, false};
  r.title = r.table->frames().description();
  r.facts = {{"scene", o.run.source},
             {"seed", options.seed},
             {"texture", options.texture},
             {"side_px", options.side_px},
             {"place", options.place}};
  return r;
}

std::vector<ReportPlot> plots_of(const Rendering& r) {
  if (r.metric)
    return {{"True position of the target", "mm", {{"x", "truth/x_m"}, {"y", "truth/y_m"}, {"z", "truth/z_m"}}, 1e3}};
  return {{"True place of the region's first corner",
           "px",
           {{"horizontal", "truth/corner0/u_px"}, {"vertical", "truth/corner0/v_px"}}}};
}

// beats.csv: the heart's R peaks; ecg.csv: what a loop would have got. Both as far as the frames go.
void write_beats(const sim::Table& table, const TimeTable& truth, const RunFolder& folder) {
  const double end = truth.rows() > 0 ? truth.time_s().back() : 0;
  TimeTable beats({"time_s"}), ecg({"time_s", "ecg_mv"});
  for (const double beat : table.beats())
    if (beat >= 0 && beat <= end) beats.append({beat});
  if (beats.rows() > 0) beats.write_csv(folder.file("beats.csv"));
  const auto source = table.ecg();
  if (!source) return;
  for (servo::EcgSample sample; source->next(end, sample);) ecg.append({sample.time_s, sample.value});
  ecg.write_csv(folder.file("ecg.csv"));
}

int run_render(RenderOptions o) {
  if (o.artificial) o.run.source = artificial_source(o.artificial, o.run);
  const Rendering rendering = o.artificial ? artificial_rendering(o) : scene_rendering(o);
  const auto& table = rendering.table;
  const std::size_t expected = table->frames().frame_count().value_or(0);
  auto columns = corner_columns();
  for (const auto& name : target_columns()) columns.push_back(name);
  if (rendering.metric)
    for (const char* name : {"truth/x_m", "truth/y_m", "truth/z_m"}) columns.emplace_back(name);
  TimeTable truth(columns, rows_ahead(expected));
  RunFolder folder(run_path(o.run, "render"));
  std::filesystem::create_directories(folder.file("frames"));
  cv::Mat first;
  bool interrupted = false;
  {
    const Interrupt interrupt;
    Progress progress("render " + stem_of(o.run.source), expected, o.run.quiet);
    servo::LoopRecord record;
    while (!(interrupted = interrupt.requested()) && table->frames().next(record.frame)) {
      write_png(folder.file(fmt::format("frames/{:06d}.png", record.frame.sequence)), record.frame.grey);
      const auto sample = table->truth(record);
      std::vector<double> row{record.frame.time_s};
      for (const auto& corner : *sample.corners_px) row.insert(row.end(), {corner.x(), corner.y()});
      const Eigen::Vector2d target = true_target_px(*table, sample);
      row.insert(row.end(), {target.x(), target.y()});
      if (sample.target) row.insert(row.end(), {sample.target->x(), sample.target->y(), sample.target->z()});
      truth.append(row);
      if (first.empty()) first = record.frame.grey.clone();
      progress.update(truth.rows());
    }
  }
  const cv::Size size = table->frames().size();
  nlohmann::json summary{{"command", "render"},       {"version", HEARTSERVO_VERSION},
                         {"frames", truth.rows()},    {"frame_rate_hz", table->frames().frame_rate_hz()},
                         {"width", size.width},       {"height", size.height},
                         {"interrupted", interrupted}};
  summary.update(rendering.facts);
  truth.write_csv(folder.file("truth.csv"));
  write_beats(*table, truth, folder);
  if (rendering.metric) tracking::write_ros_camera(table->camera(), folder.file("camera.yaml").string(), "endoscope");
  Report report;
  report.title = "render " + stem_of(o.run.source);
  report.headline = fmt::format("{} frames of {}, with truth.", truth.rows(), rendering.title);
  report.headline_number = std::to_string(truth.rows());
  report.headline_unit = "frames";
  if (!first.empty()) report.pictures = {{"first frame", first}};  // interrupted before it
  report.plots = plots_of(rendering);
  report.table = &truth;
  report.config_yaml = rendering.config;
  report.summary = summary;
  finish_run(folder, report, o.run,
             fmt::format("{} frames in {}\n", truth.rows(), (folder.path() / "frames").string()));
  return interrupted ? INTERRUPTED : DONE;
}

}  // namespace

Command add_render_command(CLI::App& program) {
  auto options = std::make_shared<RenderOptions>();
  RenderOptions& o = *options;
  CLI::App* app =
      program.add_subcommand("render", "write frames (PNG) and truth (CSV) of a scene or an artificial sequence");
  add_run_options(*app, o.run, "scene (.yaml)");
  app->add_flag("--with-tool", o.with_tool, "show the tool, standing still where a run would begin");
  add_artificial_options(*app, o.artificial);
  app->footer(
      "Examples:\n  heartservo render scenes/pig_2007.yaml --frames 250 --out rendered\n"
      "  heartservo render --artificial circle --texture retina --side 40 --background recorded/left");
  return {app, [options] { return run_render(*options); }};
}

}  // namespace heartservo::tools
