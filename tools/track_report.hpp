#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "tools/report/report.hpp"
#include "tools/track_run.hpp"

namespace heartservo::tools {

/// All lanes in one table, for plots side by side: time_s, and per tracker NAME/u_px, NAME/v_px (displacement since the
/// first frame, of the scored point where there is one, else of the region's centre), NAME/error_px (of the corners
/// where they are known, else of the point), NAME/quality, NAME/state, NAME/ms; and truth/u_px, truth/v_px where known.
TimeTable side_by_side(const std::vector<TrackLane>& lanes);

/// The page of a track run. `table`: side_by_side(lanes); it must live until the report is written.
Report track_report(const nlohmann::json& summary, const TimeTable& table, std::vector<ReportTable> paper,
                    std::vector<ReportPicture> pictures, const std::string& config_yaml);

}  // namespace heartservo::tools
