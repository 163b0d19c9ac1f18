#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "tools/report/report.hpp"

namespace heartservo::tools {

/// The page of a servo run. `table` must live until the report is written.
Report servo_report(const nlohmann::json& summary, const TimeTable& table, std::vector<ReportPicture> pictures,
                    const std::string& config_yaml);

}  // namespace heartservo::tools
