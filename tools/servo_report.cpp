#include "tools/servo_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "servo/motion/spectrum.hpp"
#include "tools/servo_summary.hpp"
#include "tools/window/selection.hpp"

namespace heartservo::tools {

namespace {

constexpr std::size_t kLeastRows = 256;             // for a spectrum
constexpr double kSegment_s = 8, kHighest_hz = 20;  // of it

using nlohmann::json;

std::vector<ReportPlot> metric_plots() {
  const auto axes = [](const std::string& group, const std::string& who) {
    return std::vector<ReportSeries>{
        {who + " x", group + "/x_m"}, {who + " y", group + "/y_m"}, {who + " z", group + "/z_m"}};
  };
  return {
      {"Motion of the heart and what is left of it",
       "mm",
       {{"heart x", "motion/x_m"},
        {"heart y", "motion/y_m"},
        {"heart z", "motion/z_m"},
        {"residual", "residual/norm_m"}},
       1e3,
       "Motion of the goal about its mean; distance of the true tip from the true goal."},
      {"Residual by axis", "mm", axes("residual", "residual"), 1e3},
      {"Commanded velocity", "mm/s", {{"x", "command/x_m_s"}, {"y", "command/y_m_s"}, {"z", "command/z_m_s"}}, 1e3}};
}

std::vector<ReportPlot> pixel_plots() {
  return {
      {"Motion of the goal in the picture and the tip's distance from it",
       "px",
       {{"goal u", "motion/u_px"}, {"goal v", "motion/v_px"}, {"residual", "residual/norm_px"}},
       1,
       "Motion of the goal about its mean, as far as the reference knows it."},
      {"Commanded velocity", "mm/s", {{"x", "command/x_m_s"}, {"y", "command/y_m_s"}, {"z", "command/z_m_s"}}, 1e3}};
}

ReportTable residual_rows(const json& j) {
  ReportTable table{"Residual", {"", "RMS", "95 %", "max"}, {}, ""};
  if (!j["residual"].is_null()) {
    const json &r = j["residual"], &a = r["axis_rms_mm"];
    table.rows.push_back({"tip to goal, mm", number(r["rms_mm"], 3), number(r["p95_mm"], 3), number(r["max_mm"], 3)});
    for (const char* axis : {"x", "y", "z"})
      table.rows.push_back({fmt::format("{}, mm", axis), number(a[axis], 3), "", ""});
    table.rows.push_back({"heart motion, mm", number(j["motion"]["rms_mm"], 3), "", ""});
  }
  const json& px = j["residual_px"];
  table.rows.push_back({"in the picture, px", number(px["rms"], 2), number(px["p95"], 2), number(px["max"], 2)});
  table.note = "Pixel residual scored against: " + reference_text(px);
  return table;
}

ReportTable run_rows(const json& j) {
  const json &t = j["tracking"], &c = j["commands"], &time = j["timing"];
  const auto text = [&](const char* key) { return j[key].get<std::string>(); };
  return {
      "Run",
      {},
      {{"frames", fmt::format("{} at {} Hz", j["frames"].get<int>(), number(j["frame_rate_hz"], 0))},
       {"latency, ms", number(j["latency_ms"], 1)},
       {"seed", std::to_string(j["seed"].get<int>())},
       {"tracker", text("tracker")},
       {"estimator", text("estimator")},
       {"predictor", text("predictor")},
       {"controller", text("controller")},
       {"robot", text("robot")},
       {"camera", text("camera")},
       {"lost frames", std::to_string(t["lost_frames"].get<int>())},
       {"uncertain frames", std::to_string(t["uncertain_frames"].get<int>())},
       {"corner error, px", t["error_px"].is_null() ? "-" : number(t["error_px"]["mean"], 3)},
       {"fastest command, mm/s", number(c["max_speed_mm_s"], 1)},
       {"tracking time p50 / p99, ms", number(time["track_ms"]["p50"], 3) + " / " + number(time["track_ms"]["p99"], 3)},
       {"chain time p50 / p99, ms", number(time["chain_ms"]["p50"], 3) + " / " + number(time["chain_ms"]["p99"], 3)},
       {"times real time", number(time["real_time_factor"], 2)}},
      ""};
}

}  // namespace

TimeTable servo_spectrum(const TimeTable& table, const json& j) {
  const double rate = j["frame_rate_hz"];
  std::vector<std::string> names{"frequency_hz"};
  std::vector<servo::Spectrum> spectra;
  const bool metric = !j["residual"].is_null();
  for (const char* group : {"motion", "residual"}) {
    servo::Spectrum sum;
    for (const char* axis : {"x_m", "y_m", "z_m"}) {
      std::vector<double> series;
      if (metric)
        for (const double v : table.column(fmt::format("{}/{}", group, axis)))
          if (std::isfinite(v)) series.push_back(v);
      if (series.size() < kLeastRows || !(rate > 0)) return TimeTable({"frequency_hz"});
      const servo::Spectrum one = servo::welch(series, rate, kSegment_s);
      if (sum.density.empty())
        sum = one;
      else
        for (std::size_t i = 0; i < sum.density.size(); ++i) sum.density[i] += one.density[i];
    }
    names.push_back(fmt::format("{}/m2_hz", group));
    spectra.push_back(std::move(sum));
  }
  TimeTable result(names, spectra[0].density.size());
  for (std::size_t i = 0; i < spectra[0].density.size() && spectra[0].frequency_hz(i) <= kHighest_hz; ++i)
    result.append({spectra[0].frequency_hz(i), spectra[0].density[i], spectra[1].density[i]});
  return result;
}

Report servo_report(const json& j, const TimeTable& table, const TimeTable& spectrum,
                    std::vector<ReportPicture> pictures, const std::string& config_yaml) {
  Report report;
  const bool metric = !j["residual"].is_null();
  report.title = "servo " + j["scene"].get<std::string>();
  const std::string left = metric ? number(j["residual"]["rms_mm"], 2) : number(j["residual_px"]["rms"], 1);
  const std::string unit = metric ? "mm" : "px";
  const std::string motion = metric ? number(j["motion"]["rms_mm"], 2) : number(j["motion_px"]["rms"], 1);
  report.headline =
      fmt::format("The tip stands still to {} {} RMS on a heart that moves {} {} RMS: {} % of the motion is cancelled.",
                  left, unit, motion, unit, number(j["reduction_percent"], 1));
  report.headline_number = left;
  report.headline_unit = unit + " RMS residual";
  if (!metric)
    report.notices.push_back(
        "Recorded frames: no 3D truth. The pixel residual is scored against: " + reference_text(j["residual_px"]) +
        (j["estimator"] == "assumed_depth" ? ". Depth is assumed." : "."));
  if (const int lost = j["tracking"]["lost_frames"]; lost > 0)
    report.notices.push_back(fmt::format("The region was lost in {} of {} frames.", lost, j["frames"].get<int>()));
  if (!j["stop_reason"].is_null()) report.notices.push_back("Safety stop: " + j["stop_reason"].get<std::string>());
  if (j["interrupted"].get<bool>()) report.notices.push_back("Ended early by Ctrl-C or q.");
  if (const std::string selected = selection_notice(j); !selected.empty()) report.notices.push_back(selected);
  report.plots = metric ? metric_plots() : pixel_plots();
  if (spectrum.rows() > 0) {
    ReportPlot density{"Spectra of the motion and of what is left",
                       "mm²/Hz",
                       {{"heart", "motion/m2_hz"}, {"residual", "residual/m2_hz"}},
                       1e6,
                       "Power spectral density, the three axes together (Welch); where the residual lies above the "
                       "heart, the loop amplifies.",
                       &spectrum};
    double highest = 0;
    for (const double d : spectrum.column("motion/m2_hz")) highest = std::max(highest, d);
    density.log_from = 1e6 * highest * 1e-8;
    report.plots.push_back(density);
  }
  report.plots.push_back(
      {"Tracking quality", "%", {{"target", "track/quality"}, {"tool marker", "marker/quality"}}, 100});
  report.plots.push_back(
      {"Computing time", "ms", {{"trackers", "timing/track_ms"}, {"whole chain", "timing/chain_ms"}}, 1});
  report.pictures = std::move(pictures);
  report.tables = {residual_rows(j), run_rows(j)};
  report.table = &table;
  report.states = {{"tracking", "track/state"}};
  report.config_yaml = config_yaml;
  report.summary = j;
  return report;
}

}  // namespace heartservo::tools
