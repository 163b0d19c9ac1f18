// heartservo render: writes a scene's frames and truth, for other programs and for tests of trackers.
#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>

#include "servo/loop/loop_record.hpp"
#include "sim/table/table.hpp"
#include "tools/command.hpp"
#include "tools/corner_truth.hpp"
#include "tools/interrupt.hpp"
#include "tools/progress.hpp"
#include "tools/report/report.hpp"
#include "tools/run_folder.hpp"
#include "tracking/camera/camera_file.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

struct RenderOptions {
  RunOptions run;
  bool with_tool = false;
};

void write_png(const std::filesystem::path& file, const cv::Mat& grey) {
  bool written = false;
  try {
    written = cv::imwrite(file.string(), grey, {cv::IMWRITE_PNG_COMPRESSION, 1});
  } catch (const cv::Exception&) {
  }
  if (!written) throw ConfigError(file.string() + ": cannot be written; check space and permissions");
}

int run_render(const RenderOptions& o) {
  if (o.run.source.empty() || !is_scene(o.run.source))
    throw ConfigError("SCENE is missing: give a scene file such as scenes/pig_2007.yaml");
  sim::Scene scene = scene_for(o.run, {});
  if (scene.is_recorded()) throw ConfigError(o.run.source + ": frames from disk need no rendering");
  scene.show_tool = o.with_tool;
  if (scene.settle_s >= scene.duration_s) scene.settle_s = 0;
  sim::require_valid(scene, o.run.source);
  const auto table = sim::make_table(scene);
  const std::size_t expected = table->frames().frame_count().value_or(0);
  auto columns = corner_columns();
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
      row.insert(row.end(), {sample.target->x(), sample.target->y(), sample.target->z()});
      truth.append(row);
      if (first.empty()) first = record.frame.grey.clone();
      progress.update(truth.rows());
    }
  }
  const nlohmann::json summary{{"command", "render"},
                               {"version", HEARTSERVO_VERSION},
                               {"scene", stem_of(o.run.source)},
                               {"seed", scene.seed},
                               {"frames", truth.rows()},
                               {"frame_rate_hz", scene.camera.frame_rate_hz},
                               {"width", table->camera().width},
                               {"height", table->camera().height},
                               {"interrupted", interrupted}};
  truth.write_csv(folder.file("truth.csv"));
  tracking::write_ros_camera(table->camera(), folder.file("camera.yaml").string(), "endoscope");
  const std::string config = config_text(scene, "render");
  folder.write("config.yaml", config);
  folder.write("summary.json", summary.dump(2) + "\n");
  Report report;
  report.title = "render " + stem_of(o.run.source);
  report.headline = fmt::format("{} frames of {}, with truth.", truth.rows(), scene.title);
  report.headline_number = std::to_string(truth.rows());
  report.headline_unit = "frames";
  if (!first.empty()) report.pictures = {{"first frame", first}};  // interrupted before it
  report.plots = {
      {"True position of the target", "mm", {{"x", "truth/x_m"}, {"y", "truth/y_m"}, {"z", "truth/z_m"}}, 1e3}};
  report.table = &truth;
  report.config_yaml = config;
  report.summary = summary;
  write_report(report, folder.file("report.html"));
  folder.finish();
  if (o.run.json)
    fmt::print("{}\n", summary.dump(2));
  else if (!o.run.quiet)
    fmt::print("{} frames in {}\n", truth.rows(), folder.file("frames").string());
  return interrupted ? INTERRUPTED : DONE;
}

}  // namespace

Command add_render_command(CLI::App& program) {
  auto options = std::make_shared<RenderOptions>();
  RenderOptions& o = *options;
  CLI::App* app = program.add_subcommand("render", "write a scene's frames (PNG) and truth (CSV)");
  add_run_options(*app, o.run, "scene (.yaml)");
  app->add_flag("--with-tool", o.with_tool, "show the tool, standing still where a run would begin");
  app->footer("Example: heartservo render scenes/pig_2007.yaml --frames 250 --out rendered");
  return {app, [options] { return run_render(*options); }};
}

}  // namespace heartservo::tools
