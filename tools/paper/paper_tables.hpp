#pragma once
// What the paper printed, beside what the runs gave; Table 5 and Fig. 7 are in track_tables.hpp.
#include <array>
#include <nlohmann/json.hpp>

#include "tools/report/report.hpp"

namespace heartservo::tools {

/// Section 4.1. `entry`: of the depth experiment's summary, paper[0].
ReportTable paper_depth(const nlohmann::json& entry);

/// Table 3: densities of the six lines. `landmarks`: summary.json of `analyse` for each.
ReportTable paper_table_3(const std::array<nlohmann::json, 2>& landmarks);

/// Table 4: largest accelerations of the two landmarks.
ReportTable paper_table_4(const std::array<nlohmann::json, 2>& landmarks);

/// Fig. 8, of which the paper prints no numbers: swings of the displacement, lost frames. `summary`: of `track`.
ReportTable paper_swings(const nlohmann::json& summary);

}  // namespace heartservo::tools
