#include "tools/calibration/calibration_summary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <filesystem>

namespace heartservo::tools {

using nlohmann::json;

namespace {

constexpr double DEGREES = 180 / M_PI;
constexpr double ENOUGH_OF_VOLUME = 0.9;
constexpr double VAGUE_FOCAL = 0.01;  // relative; depth is as wrong as the focal length
constexpr double STRAINED = 1.3;

json parameters_json(const tracking::CameraParameters& p) {
  json result;
  for (int k = 0; k < 8; ++k) result[tracking::CAMERA_PARAMETER_NAMES[k]] = p[k];
  return result;
}

json coverage_json(const CalibrationRun& run, std::size_t side) {
  const auto& volume = run.in_volume[side];
  json slices;
  for (int z = 0; z < volume.cells.z(); ++z) slices.push_back(100 * volume.share_of_slice(z));
  return {{"picture_percent", 100 * run.picture[side].share()},
          {"missing", run.picture[side].missing_parts()},
          {"volume_percent", 100 * volume.share()},
          {"volume_slices_percent", slices}};
}

json camera_json(const CalibrationRun& run, std::size_t side) {
  const auto& camera = run.calibration.cameras[side];
  json views = json::array();
  for (std::size_t p = 0; p < run.calibration.views.size(); ++p) {
    const auto& view = run.calibration.views[p][side];
    if (!view.seen) continue;
    views.push_back({{"name", run.calibration.positions[p].names[side]},
                     {"rms_px", view.rms_px},
                     {"max_px", view.max_px},
                     {"distance_mm", 1e3 * view.T_camera_board.translation().z()},
                     {"tilt_deg", DEGREES * view.tilt_rad},
                     {"dropped", view.dropped},
                     {"outlier", view.outlier}});
  }
  return {{"side", side_name(run, side)},
          {"file", side == 0 ? "camera.yaml" : "camera_right.yaml"},
          {"parameters", parameters_json(parameters_of(camera.camera))},
          {"deviation", parameters_json(camera.deviation)},
          {"rms_px", camera.rms_px},
          {"coverage", coverage_json(run, side)},
          {"views", views}};
}

json stereo_json(const CalibrationRun& run) {
  if (run.views.sides == 1) return nullptr;
  const auto& c = run.calibration;
  const Eigen::Vector3d t = c.rig.T_right_left.translation(), direction = t.normalized();
  std::size_t pairs = 0;
  for (const auto& views : c.views) pairs += views[0].seen && views[1].seen;
  return {{"file", "stereo.yaml"},
          {"pairs", pairs},
          {"baseline_mm", 1e3 * t.norm()},
          {"baseline_deviation_mm", 1e3 * std::sqrt(direction.dot(c.rig_covariance.topLeftCorner<3, 3>() * direction))},
          {"translation_mm", {1e3 * t.x(), 1e3 * t.y(), 1e3 * t.z()}},
          {"angle_deg", DEGREES * Eigen::AngleAxisd(c.rig.T_right_left.linear()).angle()},
          {"strain", c.pair_strain}};
}

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

// "12, 40 and 3 others"; corners count from 0, as in corners.csv.
std::string numbers_of(const std::vector<std::size_t>& dropped) {
  constexpr std::size_t MANY = 5;
  const auto end = dropped.begin() + static_cast<std::ptrdiff_t>(std::min(MANY, dropped.size()));
  const std::string text = fmt::format("{}", fmt::join(dropped.begin(), end, ", "));
  return dropped.size() <= MANY ? text : fmt::format("{} and {} others", text, dropped.size() - MANY);
}

void warn_of_side(const CalibrationRun& run, std::size_t side, std::vector<std::string>& warnings) {
  const std::string who = run.views.sides == 1 ? "" : side_name(run, side) + ": ";
  const auto add = [&](const std::string& text) { warnings.push_back(who + text); };
  const auto& c = run.calibration;
  const auto& camera = c.cameras[side];
  const double vagueness = std::max(camera.deviation[0] / camera.camera.fx, camera.deviation[1] / camera.camera.fy);
  if (vagueness > VAGUE_FOCAL)
    add(
        fmt::format("the focal length is known to {:.1f} % only, and so is every depth ({:.1f} mm at {:.0f} mm); tilt "
                    "the board more, by 20 to 45 degrees to several sides",
                    100 * vagueness, 1e3 * vagueness * run.volume.distance_m, 1e3 * run.volume.distance_m));
  for (std::size_t p = 0; p < c.views.size(); ++p)
    if (c.views[p][side].outlier)
      add(fmt::format("{} fits worse than the others ({:.2f} px); look whether it is blurred, or leave it out",
                      file_name(c.positions[p].names[side]), c.views[p][side].rms_px));
  for (std::size_t p = 0; p < c.views.size(); ++p)
    if (const auto& dropped = c.views[p][side].dropped; !dropped.empty())
      add(fmt::format("{}: {} {} ({:.1f} px off) left out", file_name(c.positions[p].names[side]),
                      dropped.size() == 1 ? "corner" : "corners", numbers_of(dropped),
                      c.views[p][side].residuals[dropped[0]].norm()));
  const auto missing = run.picture[side].missing_parts();
  if (!missing.empty())
    add(fmt::format("there was no board in this part of the picture: {}; the lens is extrapolated there",
                    fmt::join(missing, ", ")));
  if (const auto& volume = run.in_volume[side]; volume.share() < ENOUGH_OF_VOLUME) {
    std::string slices;
    for (int z = 0; z < volume.cells.z(); ++z)
      slices += fmt::format("{}{:.0f}", z == 0 ? "" : ", ", 100 * volume.share_of_slice(z));
    add(
        fmt::format("the board was in {:.0f} % of the working volume of {} (from near to far: {} %); depths are less "
                    "certain where it was not",
                    100 * volume.share(), run.volume.description(), slices));
  }
}

}  // namespace

CalibrationRun calibration_run(BoardViews views, tracking::Calibration calibration,
                               const tracking::WorkingVolume& volume) {
  CalibrationRun run{std::move(views), std::move(calibration), volume, {}, {}};
  const auto& c = run.calibration;
  for (std::size_t side = 0; side < run.views.sides; ++side) {
    std::vector<tracking::Corners> corners;
    std::vector<Eigen::Vector3d> points;
    for (std::size_t p = 0; p < c.views.size(); ++p) {
      if (!c.views[p][side].seen) continue;
      corners.push_back(c.positions[p].corners[side]);
      for (const auto& point : c.rig.points) points.push_back(c.views[p][side].T_camera_board * point);
    }
    run.picture.push_back(tracking::picture_coverage(run.views.width, run.views.height, corners));
    run.in_volume.push_back(tracking::volume_coverage(volume, points));
  }
  return run;
}

std::string side_name(const CalibrationRun& run, std::size_t side) {
  return run.views.sides == 1 ? "camera" : side == 0 ? "left" : "right";
}

std::vector<std::string> calibration_warnings(const CalibrationRun& run) {
  std::vector<std::string> warnings;
  const auto& c = run.calibration;
  if (c.free_board)
    warnings.push_back(fmt::format(
        "the board is not as printed: its points are off by {:.3f} mm RMS, {:.3f} mm at most; its shape was estimated "
        "along with the camera (--board-shape flat trusts the print)",
        1e3 * c.board_rms_m, 1e3 * c.board_max_m));
  if (c.pair_strain > STRAINED)
    warnings.push_back(
        fmt::format("together the two cameras fit {:.1f} times worse than alone; were the pictures of each pair taken "
                    "at the same time, and are they in the same order?",
                    c.pair_strain));
  for (std::size_t side = 0; side < run.views.sides; ++side) warn_of_side(run, side, warnings);
  return warnings;
}

json calibration_summary(const CalibrationRun& run) {
  const auto& c = run.calibration;
  const auto& board = run.views.board;
  json skipped = json::array(), cameras = json::array();
  for (const auto& view : run.views.skipped) skipped.push_back({{"name", view.name}, {"reason", view.reason}});
  for (std::size_t side = 0; side < run.views.sides; ++side) cameras.push_back(camera_json(run, side));
  const auto& size = run.volume.size_m;
  return {
      {"command", "calibrate"},
      {"version", HEARTSERVO_VERSION},
      {"board",
       {{"kind", board.kind == tracking::BoardKind::CHESSBOARD ? "chessboard" : "circles"},
        {"columns", board.columns},
        {"rows", board.rows},
        {"square_mm", 1e3 * board.pitch_m},
        {"circle_mm", board.disc_m > 0 ? json(1e3 * board.disc_m) : json(nullptr)},
        {"shape", c.free_board ? "free" : "flat"},
        {"evidence", c.shape_evidence > 0 ? json(c.shape_evidence) : json(nullptr)},
        {"rms_mm", 1e3 * c.board_rms_m},
        {"max_mm", 1e3 * c.board_max_m}}},
      {"picture", {{"width", run.views.width}, {"height", run.views.height}}},
      {"views", {{"given", run.views.given}, {"used", run.views.given - skipped.size()}, {"skipped", skipped}}},
      {"rms_px", c.rms_px},
      {"sigma_px", c.sigma_px},
      {"working_volume",
       {{"size_mm", {1e3 * size.x(), 1e3 * size.y(), 1e3 * size.z()}}, {"distance_mm", 1e3 * run.volume.distance_m}}},
      {"cameras", cameras},
      {"stereo", stereo_json(run)},
      {"warnings", calibration_warnings(run)}};
}

std::string corners_csv(const CalibrationRun& run) {
  std::string text = "side,view,point,u_px,v_px,du_px,dv_px\n";
  const auto& c = run.calibration;
  for (std::size_t side = 0; side < run.views.sides; ++side)
    for (std::size_t p = 0; p < c.views.size(); ++p)
      for (std::size_t i = 0; i < c.views[p][side].residuals.size(); ++i) {
        const auto &pixel = c.positions[p].corners[side][i], &residual = c.views[p][side].residuals[i];
        text += fmt::format("{},{},{},{:.4f},{:.4f},{:.4f},{:.4f}\n", side_name(run, side), p, i, pixel.x(), pixel.y(),
                            residual.x(), residual.y());
      }
  return text;
}

}  // namespace heartservo::tools
