#pragma once
#include "tools/analyse_summary.hpp"
#include "tools/time_table.hpp"

namespace heartservo::tools {

/// motion.csv: `time_s`, and per axis position, its respiration and beat (m), velocity (m/s), acceleration (m/s^2);
/// truth/... where the record has one. On the even grid of the analysis.
TimeTable motion_table(const AnalysisRun& run);

/// spectrum.csv: `frequency_hz` and the density of each axis (m^2/Hz), and of the truth.
TimeTable spectrum_table(const AnalysisRun& run);

/// Both tables must live until the report is written.
Report analyse_report(const AnalysisRun& run, const nlohmann::json& summary, const TimeTable& motion,
                      const TimeTable& spectrum, const std::string& config_yaml);

}  // namespace heartservo::tools
