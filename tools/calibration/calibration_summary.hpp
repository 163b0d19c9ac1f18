#pragma once
// A calibration as summary.json, and as the text that people read of it.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/calibration/board_views.hpp"
#include "tracking/camera/calibration/calibration.hpp"
#include "tracking/camera/calibration/coverage.hpp"

namespace heartservo::tools {

/// Everything about a finished calibration.
struct CalibrationRun {
  BoardViews views;
  tracking::Calibration calibration;
  tracking::WorkingVolume volume;
  std::vector<tracking::PictureCoverage> picture;   ///< one a side
  std::vector<tracking::VolumeCoverage> in_volume;  ///< one a side
};

/// Fills in the coverage.
CalibrationRun calibration_run(BoardViews views, tracking::Calibration calibration,
                               const tracking::WorkingVolume& volume);

/// "left" and "right", or "camera" where there is one.
std::string side_name(const CalibrationRun& run, std::size_t side);

/// What is to be known before the camera is used.
std::vector<std::string> calibration_warnings(const CalibrationRun& run);

/// {"command", "version", "board": {"kind", "columns", "rows", "square_mm", "circle_mm", "shape", "evidence", "rms_mm",
///  "max_mm"}, "picture": {"width", "height"}, "views": {"given", "used", "skipped": [{"name", "reason"}]}, "rms_px",
///  "sigma_px", "working_volume", "cameras": [{"side", "file", "parameters": {...}, "deviation": {...}, "rms_px",
///  "coverage": {"picture_percent", "missing", "volume_percent", "volume_slices_percent"}, "views": [{"name", "rms_px",
///  "max_px", "distance_mm", "tilt_deg", "dropped": [corner numbers], "outlier"}]}], "stereo": null or {"file",
///  "pairs", "baseline_mm", "baseline_deviation_mm", "translation_mm", "angle_deg", "strain"}, "warnings": [...]}
nlohmann::json calibration_summary(const CalibrationRun& run);
std::string calibration_text(const nlohmann::json& summary);

/// side,view,point,u_px,v_px,du_px,dv_px: every corner as used, and its residual (measured less computed).
std::string corners_csv(const CalibrationRun& run);

}  // namespace heartservo::tools
