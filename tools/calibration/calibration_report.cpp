#include "tools/calibration/calibration_report.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "tools/calibration/calibration_pictures.hpp"

namespace heartservo::tools {

using nlohmann::json;

namespace {

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

void add_pictures(const CalibrationRun& run, std::size_t side, std::vector<ReportPicture>& pictures) {
  const std::string who = run.views.sides == 1 ? "" : side_name(run, side) + ": ";
  double enlarged = 0, reach_px = 0;
  const cv::Mat coverage = draw_picture_coverage(run, side, enlarged);
  pictures.push_back(
      {fmt::format("{}Where the board was seen, a colour a view; shaded: not seen. Lines are errors, {:.0f} "
                   "times as long.",
                   who, enlarged),
       coverage});
  const cv::Mat errors = draw_errors(run, side, reach_px);
  pictures.push_back({fmt::format("{}Errors of the corners, up to {:.3g} px; the circle is their standard deviation of "
                                  "{:.3f} px.",
                                  who, reach_px, run.calibration.sigma_px),
                      errors});
  pictures.push_back(
      {fmt::format("{}Board points in the cells of the working volume of {}, as the camera sees its slices.", who,
                   run.volume.description()),
       draw_volume_coverage(run, side)});
}

ReportTable parameter_table(const json& camera, bool several) {
  ReportTable table{several ? "Parameters, " + camera["side"].get<std::string>() : "Parameters",
                    {"", "value", "std"},
                    {},
                    "fx, fy, cx, cy in px; k1, k2 radial, k3, k4 tangential (OpenCV's p1, p2)."};
  for (const char* name : tracking::CAMERA_PARAMETER_NAMES) {
    const char* format = name[0] == 'k' ? "{:.5f}" : "{:.2f}";
    const auto cell = [&](const char* group) {
      return fmt::format(fmt::runtime(format), camera[group][name].get<double>());
    };
    table.rows.push_back({name, cell("parameters"), cell("deviation")});
  }
  return table;
}

ReportTable view_table(const json& camera, bool several) {
  ReportTable table{several ? "Views, " + camera["side"].get<std::string>() : "Views",
                    {"view", "RMS px", "max px", "distance mm", "tilt deg", ""},
                    {},
                    "RMS and maximum distance of the corners from where the model has them."};
  for (const auto& view : camera["views"])
    table.rows.push_back(
        {file_name(view["name"].get<std::string>()), fmt::format("{:.3f}", view["rms_px"].get<double>()),
         fmt::format("{:.3f}", view["max_px"].get<double>()), fmt::format("{:.1f}", view["distance_mm"].get<double>()),
         fmt::format("{:.1f}", view["tilt_deg"].get<double>()), view["outlier"].get<bool>() ? "outlier" : ""});
  return table;
}

ReportTable stereo_table(const json& stereo) {
  const auto t = stereo["translation_mm"].get<std::vector<double>>();
  return {"Stereo",
          {},
          {{"baseline, mm", fmt::format("{:.3f} ± {:.3f}", stereo["baseline_mm"].get<double>(),
                                        stereo["baseline_deviation_mm"].get<double>())},
           {"left camera in the right frame, mm", fmt::format("{:.3f}, {:.3f}, {:.3f}", t[0], t[1], t[2])},
           {"angle, deg", fmt::format("{:.3f}", stereo["angle_deg"].get<double>())},
           {"pairs", std::to_string(stereo["pairs"].get<int>())}},
          ""};
}

ReportTable skipped_table(const json& skipped) {
  ReportTable table{"Skipped", {"picture", "reason"}, {}, ""};
  for (const auto& view : skipped) table.rows.push_back({file_name(view["name"]), view["reason"]});
  return table;
}

}  // namespace

Report calibration_report(const CalibrationRun& run, const json& s, const std::string& config_yaml) {
  Report report;
  report.title = "calibrate " + run.views.board.description();
  const bool several = run.views.sides > 1;
  const double rms = s["rms_px"];
  report.headline_number = fmt::format("{:.3f}", rms);
  report.headline_unit = "px RMS reprojection error";
  const auto& p = s["cameras"][0]["parameters"];
  const auto& d = s["cameras"][0]["deviation"];
  report.headline = fmt::format("{} of {} views fit the {} to {:.3f} px RMS; fx is {:.1f} ± {:.1f} px.",
                                s["views"]["used"].get<int>(), s["views"]["given"].get<int>(),
                                several ? "two cameras" : "camera", rms, p["fx"].get<double>(), d["fx"].get<double>());
  for (const auto& warning : s["warnings"]) report.notices.push_back(warning);
  for (std::size_t side = 0; side < run.views.sides; ++side) {
    add_pictures(run, side, report.pictures);
    report.tables.push_back(parameter_table(s["cameras"][side], several));
  }
  if (run.calibration.free_board) {
    double largest_m = 0;
    const cv::Mat shape = draw_board_shape(run, largest_m);
    report.pictures.push_back({fmt::format("The board's shape: orange towards the camera, blue away from it, up to "
                                           "{:.3f} mm along its normal.",
                                           1e3 * largest_m),
                               shape});
  }
  if (several) report.tables.push_back(stereo_table(s["stereo"]));
  for (std::size_t side = 0; side < run.views.sides; ++side)
    report.tables.push_back(view_table(s["cameras"][side], several));
  if (!s["views"]["skipped"].empty()) report.tables.push_back(skipped_table(s["views"]["skipped"]));
  report.config_yaml = config_yaml;
  report.summary = s;
  return report;
}

}  // namespace heartservo::tools
