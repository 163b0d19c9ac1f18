#pragma once
#include "tools/calibration/calibration_summary.hpp"
#include "tools/report/report.hpp"

namespace heartservo::tools {

/// report.html of a calibration: coverage and errors as pictures, parameters and views as tables.
Report calibration_report(const CalibrationRun& run, const nlohmann::json& summary, const std::string& config_yaml);

}  // namespace heartservo::tools
