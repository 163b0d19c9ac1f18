#include "tools/window/selection.hpp"

#include <fmt/format.h>

#include "tracking/frames/frame.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

using nlohmann::json;

void note_selection(json& selections, const tracking::Frame& frame, const tracking::Quad& region) {
  json corners;
  for (const auto& corner : region)
    for (const double v : {corner.x(), corner.y()}) corners.push_back(v);
  selections.push_back({{"time_s", frame.time_s}, {"sequence", frame.sequence}, {"corners_px", corners}});
}

tracking::Quad selected_region(LiveWindow& window, const tracking::Frame* frame, const std::string& source) {
  if (!frame) throw InputError(source + ": there is no frame");
  if (frame->status != tracking::FrameStatus::OK)
    throw InputError(frame->note + "; the first frame must show the region");
  const auto region = window.select(frame->colour.empty() ? frame->grey : frame->colour, [] { return false; });
  if (!region) throw ConfigError("--select: the window was closed before four corners were clicked; nothing was run");
  return *region;
}

std::string selection_notice(const json& summary) {
  const json selections = summary.value("selections", json::array());
  if (selections.empty()) return "";
  std::string times;
  for (const json& s : selections)
    times += fmt::format("{}{:.2f} s", times.empty() ? "" : ", ", s["time_s"].get<double>());
  return fmt::format(
      "The region was selected or learnt anew by hand at {}: scores hold as far as that is the region that the source "
      "knows.",
      times);
}

}  // namespace heartservo::tools
