#include <fmt/format.h>

#include <filesystem>

#include "tools/calibration/calibration_summary.hpp"

namespace heartservo::tools {

using nlohmann::json;

namespace {

std::string file_name(const json& path) { return std::filesystem::path(path.get<std::string>()).filename().string(); }

std::string parameter_rows(const json& cameras) {
  std::string text = fmt::format("\n{:<4}", "");
  for (const auto& camera : cameras) text += fmt::format(" {:>12}   {:<11}", camera["side"].get<std::string>(), "std");
  for (const char* name : tracking::CAMERA_PARAMETER_NAMES) {
    text += fmt::format("\n{:<4}", name);
    const bool pixels = name[0] != 'k';
    for (const auto& camera : cameras) {
      const double value = camera["parameters"][name], deviation = camera["deviation"][name];
      text += pixels ? fmt::format(" {:>12.3f} ± {:<11.3f}", value, deviation)
                     : fmt::format(" {:>12.5f} ± {:<11.5f}", value, deviation);
    }
  }
  return text + "\n";
}

std::string view_rows(const json& camera, bool with_side) {
  std::string text = fmt::format("\n{:<32} {:>8} {:>8} {:>12} {:>9}\n",
                                 with_side ? camera["side"].get<std::string>() + " view" : "view", "RMS px", "max px",
                                 "distance mm", "tilt deg");
  for (const auto& view : camera["views"])
    text += fmt::format("{:<32} {:>8.3f} {:>8.3f} {:>12.1f} {:>9.1f}{}\n", file_name(view["name"]),
                        view["rms_px"].get<double>(), view["max_px"].get<double>(), view["distance_mm"].get<double>(),
                        view["tilt_deg"].get<double>(), view["outlier"].get<bool>() ? "  outlier" : "");
  const auto& coverage = camera["coverage"];
  return text + fmt::format("{:<32} {:>8.3f}   seen: {:.0f} % of the picture, {:.0f} % of the working volume\n", "all",
                            camera["rms_px"].get<double>(), coverage["picture_percent"].get<double>(),
                            coverage["volume_percent"].get<double>());
}

}  // namespace

std::string calibration_text(const json& s) {
  const auto& board = s["board"];
  std::string text =
      fmt::format("{} of {} views of a {} of {} x {}, {:.4g} mm\n", s["views"]["used"].get<int>(),
                  s["views"]["given"].get<int>(), board["kind"].get<std::string>(), board["columns"].get<int>(),
                  board["rows"].get<int>(), board["square_mm"].get<double>());
  for (const auto& view : s["views"]["skipped"])
    text += fmt::format("skipped {}: {}\n", view["name"].get<std::string>(), view["reason"].get<std::string>());
  text += parameter_rows(s["cameras"]);
  for (const auto& camera : s["cameras"]) text += view_rows(camera, s["cameras"].size() > 1);
  if (const auto& stereo = s["stereo"]; !stereo.is_null())
    text += fmt::format("\nstereo: baseline {:.3f} ± {:.3f} mm, angle {:.2f} deg, {} pairs\n",
                        stereo["baseline_mm"].get<double>(), stereo["baseline_deviation_mm"].get<double>(),
                        stereo["angle_deg"].get<double>(), stereo["pairs"].get<int>());
  for (const auto& warning : s["warnings"]) text += fmt::format("\nwarning: {}", warning.get<std::string>());
  return text + (s["warnings"].empty() ? "" : "\n");
}

}  // namespace heartservo::tools
