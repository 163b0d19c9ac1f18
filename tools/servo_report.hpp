#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "tools/report/report.hpp"

namespace heartservo::tools {

/// `frequency_hz` and the densities of motion and residual, the three axes together (motion/m2_hz, residual/m2_hz); no
/// rows where there is no metric truth, or too little of it. `table`: with_motion() of the run's frames.
TimeTable servo_spectrum(const TimeTable& table, const nlohmann::json& summary);

/// The page of a servo run. Both tables must live until the report is written.
Report servo_report(const nlohmann::json& summary, const TimeTable& table, const TimeTable& spectrum,
                    std::vector<ReportPicture> pictures, const std::string& config_yaml);

}  // namespace heartservo::tools
