// heartservo calibrate: a camera, or a stereo pair, from pictures of a board or from lists of its corners.
#include <fmt/format.h>

#include "tools/calibration/calibration_report.hpp"
#include "tools/command.hpp"
#include "tools/run_folder.hpp"
#include "tracking/camera/camera_file.hpp"
#include "tracking/camera/stereo_camera.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using tracking::BoardKind;
using tracking::BoardShape;

struct CalibrateOptions {
  std::vector<std::string> pictures, corners, right;
  std::string board = "chessboard", shape = "auto";
  int columns = 0, rows = 0;
  double square_mm = 0, circle_mm = 0, distance_mm = 55;
  std::vector<double> volume_mm{20, 15, 15};
  std::vector<int> size;
  RunOptions run;
};

tracking::Board board_of(const CalibrateOptions& o) {
  const BoardKind kind = o.board == "circles" ? BoardKind::CIRCLES : BoardKind::CHESSBOARD;
  for (const auto& [name, missing] : {std::pair{"--columns", o.columns == 0}, {"--rows", o.rows == 0}})
    if (missing)
      throw ConfigError(fmt::format("{} is missing: give the number of {} of the board", name,
                                    kind == BoardKind::CIRCLES ? "circles" : "inner corners"));
  if (o.square_mm == 0) throw ConfigError("--square-mm is missing: give the distance from one to the next in mm");
  if (o.circle_mm > 0 && kind != BoardKind::CIRCLES) throw ConfigError("--circle-mm is for --board circles");
  if (o.circle_mm >= o.square_mm && o.circle_mm > 0)
    throw ConfigError(fmt::format("--circle-mm {} must be smaller than --square-mm {}", o.circle_mm, o.square_mm));
  return {kind, o.columns, o.rows, 1e-3 * o.square_mm, 1e-3 * o.circle_mm};
}

ViewSources sources_of(const CalibrateOptions& o) {
  if (o.pictures.empty() && o.corners.empty())
    throw ConfigError("PICTURES are missing: give pictures of a board, folders of them, or --corners with lists");
  if (!o.pictures.empty() && !o.corners.empty()) throw ConfigError("give pictures or --corners, not both");
  const bool lists = !o.corners.empty();
  if (lists && o.size.empty())
    throw ConfigError("--size is missing: lists do not tell the picture's width,height in px");
  if (!lists && !o.size.empty()) throw ConfigError("--size is for --corners; pictures tell theirs");
  return {lists ? o.corners : o.pictures, o.right, lists, lists ? o.size[0] : 0, lists ? o.size[1] : 0,
          o.run.quiet || o.run.json};
}

std::string config_of(const CalibrateOptions& o, const CalibrationRun& run) {
  std::string text = fmt::format("# heartservo {} calibrate: the resolved configuration\n", HEARTSERVO_VERSION);
  text += fmt::format("board: {}\ncolumns: {}\nrows: {}\nsquare_mm: {}\ncircle_mm: {}\nboard_shape: {}\n", o.board,
                      o.columns, o.rows, o.square_mm, 1e3 * run.views.board.disc_m, o.shape);
  text += fmt::format("size_px: [{}, {}]\nvolume_mm: [{}, {}, {}]\ndistance_mm: {}\n", run.views.width,
                      run.views.height, o.volume_mm[0], o.volume_mm[1], o.volume_mm[2], o.distance_mm);
  const auto list = [&](const std::string& key, const std::vector<std::string>& paths) {
    if (paths.empty()) return;
    text += key + ":\n";
    for (const auto& path : paths)
      text += "  - " + nlohmann::json(std::filesystem::absolute(path).string()).dump() + "\n";
  };
  list("pictures", o.pictures);
  list("corners", o.corners);
  list("right", o.right);
  return text;
}

// Too few views: then the reasons for which the others were skipped are the news.
void require_enough(const BoardViews& views) {
  for (std::size_t side = 0; side < views.sides; ++side) {
    std::size_t usable = 0;
    for (const auto& position : views.positions) usable += !position.corners[side].empty();
    if (usable >= 3 || views.skipped.empty()) continue;
    throw InputError(
        fmt::format("the board is in {} of {} {}pictures; 3 or more are needed, better 10. {}: {}{}", usable,
                    views.given / views.sides,
                    views.sides == 1 ? ""
                    : side == 0      ? "left "
                                     : "right ",
                    views.skipped[0].name, views.skipped[0].reason,
                    views.skipped.size() > 1 ? fmt::format(" (and {} others)", views.skipped.size() - 1) : ""));
  }
}

tracking::StereoCamera stereo_of(const CalibrationRun& run) {
  const auto& cameras = run.calibration.cameras;
  return {cameras[0].camera, cameras[1].camera, run.calibration.rig.T_right_left};
}

void require_pair(const CalibrationRun& run) {
  if (run.views.sides == 1) return;
  const auto stereo = stereo_of(run);
  if (!stereo.validate().empty())
    throw InputError(
        fmt::format("left and right camera would be {:.4g} mm apart, which no stereo endoscope is; are the "
                    "sides the same pictures, or is --square-mm wrong?",
                    1e3 * stereo.baseline_m()));
}

void write_cameras(const CalibrationRun& run, const RunFolder& folder) {
  const auto& cameras = run.calibration.cameras;
  tracking::write_ros_camera(cameras[0].camera, folder.file("camera.yaml").string(), side_name(run, 0));
  if (cameras.size() == 1) return;
  tracking::write_ros_camera(cameras[1].camera, folder.file("camera_right.yaml").string(), side_name(run, 1));
  tracking::write_stereo_camera(stereo_of(run), folder.file("stereo.yaml").string());
}

int run_calibrate(CalibrateOptions o) {
  const auto board = board_of(o);
  const auto sources = sources_of(o);
  o.run.source = sources.left[0];
  const auto shape = o.shape == "flat" ? BoardShape::FLAT : o.shape == "free" ? BoardShape::FREE : BoardShape::AUTO;
  const tracking::WorkingVolume volume{1e-3 * Eigen::Vector3d(o.volume_mm[0], o.volume_mm[1], o.volume_mm[2]),
                                       1e-3 * o.distance_mm};
  auto views = collect_views(board, sources);
  require_enough(views);
  auto calibration = tracking::calibrate(views.board, views.width, views.height, views.sides, views.positions, {shape});
  const auto run = calibration_run(std::move(views), std::move(calibration), volume);
  require_pair(run);
  const auto summary = calibration_summary(run);
  const Report report = calibration_report(run, summary, config_of(o, run));
  RunFolder folder(run_path(o.run, "calibrate"));
  write_cameras(run, folder);
  folder.write("corners.csv", corners_csv(run));
  finish_run(folder, report, o.run, calibration_text(summary));
  return DONE;
}

}  // namespace

Command add_calibrate_command(CLI::App& program) {
  auto options = std::make_shared<CalibrateOptions>();
  CalibrateOptions& o = *options;
  CLI::App* app = program.add_subcommand("calibrate", "camera from pictures of a board or lists of its corners");
  app->add_option("pictures", o.pictures, "pictures of the board, or folders of them");
  app->add_option("--corners", o.corners, "instead: lists of its corners, 'u v' in px a line, row by row; or folders")
      ->type_name("FILE");
  app->add_option("--right", o.right, "the same of the right camera of a stereo pair, in the same order")
      ->type_name("FILE");
  app->add_option("--board", o.board, "chessboard (default) or circles")->check(one_of({"chessboard", "circles"}));
  app->add_option("--columns", o.columns, "inner corners, or circles, in a row")->check(CLI::Range(3, 200));
  app->add_option("--rows", o.rows, "rows of them")->check(CLI::Range(3, 200));
  app->add_option("--square-mm", o.square_mm, "side of a square, or from circle to circle")->check(finite(0.01, 1000));
  app->add_option("--circle-mm", o.circle_mm, "diameter of a circle (default: as the pictures show it)")
      ->check(finite(0.01, 1000));
  app->add_option("--size", o.size, "width,height of the picture in px; for --corners")
      ->delimiter(',')
      ->expected(2)
      ->check(CLI::Range(16, 100000));
  app->add_option("--board-shape", o.shape, "flat as printed, free (estimated along), or auto (default): as it shows")
      ->check(one_of({"auto", "flat", "free"}));
  app->add_option("--volume-mm", o.volume_mm, "working volume x,y,z to be covered (default 20,15,15)")
      ->delimiter(',')
      ->expected(3)
      ->check(finite(1, 10000));
  app->add_option("--distance-mm", o.distance_mm, "of its centre from the endoscope's tip (default 55)")
      ->check(finite(1, 100000));
  app->add_option("--out", o.run.out, "run folder (default: runs/calibrate-NAME-DATE)")->type_name("DIR");
  app->add_flag("--json", o.run.json, "print summary.json on stdout and nothing else");
  app->add_flag("--quiet", o.run.quiet, "no progress and no table");
  app->footer(
      "Examples:\n  heartservo calibrate PICTURES --columns 9 --rows 7 --square-mm 2.5\n"
      "  heartservo calibrate --corners LEFT_LISTS --right RIGHT_LISTS --size 1920,1080 --columns 14 --rows 10 "
      "--square-mm 3\n"
      "The run folder holds camera.yaml (with --right also camera_right.yaml and stereo.yaml), report.html,\n"
      "summary.json and corners.csv. docs/calibration.md says how to take the pictures.");
  return {app, [options] { return run_calibrate(*options); }};
}

}  // namespace heartservo::tools
