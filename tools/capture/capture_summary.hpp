#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "tools/report/report.hpp"
#include "tracking/frames/live_source.hpp"

namespace heartservo::tools {

/// What a camera was asked for, granted and measured, and what happened to it: {device, wanted, granted, measured,
/// frames, event_counts, events}. Part of summary.json of every run on a live camera.
nlohmann::json json_of(const tracking::CaptureReport& report);

/// Wanted, granted and measured, side by side; and the events.
ReportTable capture_table(const nlohmann::json& capture);
ReportTable event_table(const nlohmann::json& capture);

/// The same for the terminal; of the events the last few.
std::string capture_text(const nlohmann::json& capture);

}  // namespace heartservo::tools
