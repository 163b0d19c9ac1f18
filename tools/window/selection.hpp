#pragma once
// Regions that someone selected in the live window, for summary.json and its readers.
#include <nlohmann/json.hpp>

#include "tools/window/live_window.hpp"

namespace heartservo::tracking {
struct Frame;
}

namespace heartservo::tools {

/// Adds {time_s, sequence, corners_px: [u1, v1, ..., v4]} to summary["selections"].
void note_selection(nlohmann::json& selections, const tracking::Frame& frame, const tracking::Quad& region);

/// Four corners clicked in a frame, null where the source has none. Throws InputError (no picture), ConfigError (closed
/// without a region).
tracking::Quad selected_region(LiveWindow& window, const tracking::Frame* frame, const std::string& source);

/// What a report says of them; "" for none.
std::string selection_notice(const nlohmann::json& summary);

}  // namespace heartservo::tools
