#include "tools/capture/capture_summary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace heartservo::tools {

using nlohmann::json;

namespace {

constexpr std::size_t SHOWN_EVENTS = 12;

std::string text_of(const json& j, const char* key) { return j[key].is_string() ? j[key].get<std::string>() : "-"; }

}  // namespace

json json_of(const tracking::CaptureReport& r) {
  const auto known = [](double value) { return value > 0 ? json(value) : json(); };
  const auto given = [](const std::string& text) { return text.empty() ? json() : json(text); };
  json events = json::array();
  for (const auto& e : r.events) events.push_back({{"time_s", e.time_s}, {"event", e.name}, {"detail", e.detail}});
  return {{"device", r.device},
          {"card", r.card},
          {"driver", r.driver},
          {"input", given(r.input)},
          {"wanted", r.wanted},
          {"granted",
           {{"format", r.granted},
            {"rate_hz", known(r.granted_rate_hz)},
            {"timings", given(r.timings)},
            {"controls", r.controls},
            {"crop", given(r.crop)},
            {"time_stamps", given(r.stamps)}}},
          {"measured",
           {{"rate_hz", r.measured_rate_hz},
            {"jitter_ms", r.jitter_ms},
            {"transfer_ms", r.transfer_ms},
            {"decode_ms", r.decode_ms}}},
          {"frames",
           {{"delivered", r.frames},
            {"skipped", r.skipped},
            {"missing", r.missing},
            {"bad", r.bad},
            {"queue_dropped", r.queue_dropped}}},
          {"event_counts", r.event_counts.empty() ? json::object() : json(r.event_counts)},
          {"events", events}};
}

ReportTable capture_table(const json& c) {
  const json &granted = c["granted"], &measured = c["measured"], &frames = c["frames"];
  ReportTable table{"Camera", {}, {}, ""};
  const auto row = [&](const std::string& key, const std::string& value) { table.rows.push_back({key, value}); };
  row("device", fmt::format("{} ({})", c["device"].get<std::string>(), c["card"].get<std::string>()));
  row("wanted", c["wanted"].get<std::string>());
  row("granted", granted["format"].get<std::string>());
  for (const char* key : {"timings", "crop", "time_stamps"})
    if (granted[key].is_string()) row(key, text_of(granted, key));
  if (c["input"].is_string()) row("input", text_of(c, "input"));
  for (const auto& control : granted["controls"]) row("control", control.get<std::string>());
  row("measured", fmt::format("{:.2f} Hz, jitter {:.2f} ms, {:.1f} ms from the time stamp to us, decoding {:.2f} ms",
                              measured["rate_hz"].get<double>(), measured["jitter_ms"].get<double>(),
                              measured["transfer_ms"].get<double>(), measured["decode_ms"].get<double>()));
  row("frames", fmt::format("{} delivered, {} skipped for newer ones, {} missing, {} bad, {} lost to a full queue",
                            frames["delivered"].get<int>(), frames["skipped"].get<int>(), frames["missing"].get<int>(),
                            frames["bad"].get<int>(), frames["queue_dropped"].get<int>()));
  return table;
}

ReportTable event_table(const json& c) {
  ReportTable table{"What happened to the camera", {"time, s", "event", "detail"}, {}, ""};
  for (const auto& e : c["events"])
    table.rows.push_back({fmt::format("{:.3f}", e["time_s"].get<double>()), e["event"].get<std::string>(),
                          e["detail"].get<std::string>()});
  if (table.rows.empty()) table.note = "Nothing.";
  return table;
}

std::string capture_text(const json& c) {
  std::string text;
  for (const auto& row : capture_table(c).rows) text += fmt::format("{:<12}{}\n", row[0], row[1]);
  const auto& events = c["events"];
  if (events.empty()) return text + "events      none\n";
  std::vector<std::string> counts;
  for (const auto& [name, count] : c["event_counts"].items())
    counts.push_back(fmt::format("{} {}", name, count.get<int>()));
  text += fmt::format("events      {}\n", fmt::join(counts, ", "));
  for (std::size_t i = events.size() > SHOWN_EVENTS ? events.size() - SHOWN_EVENTS : 0; i < events.size(); ++i)
    text += fmt::format("  {:>9.3f} s  {:<20}{}\n", events[i]["time_s"].get<double>(),
                        events[i]["event"].get<std::string>(), events[i]["detail"].get<std::string>());
  return text;
}

}  // namespace heartservo::tools
