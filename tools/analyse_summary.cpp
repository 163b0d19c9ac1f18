#include "tools/analyse_summary.hpp"

#include <fmt/format.h>

#include "tools/servo_summary.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;
using servo::MotionLine;

constexpr const char* kAxes[] = {"x", "y", "z"};

json xyz(const Eigen::Vector3d& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

json line_json(const MotionLine& line) {
  constexpr const char* kFamilies[] = {"respiration", "heart", "sideband", "other"};
  json j{{"name", name_of(line)},
         {"family", kFamilies[static_cast<int>(line.family)]},
         {"harmonic", line.harmonic},
         {"frequency_hz", line.frequency_hz},
         {"band_hz", {line.low_hz, line.high_hz}},
         {"density_percent", xyz(line.density_percent)},
         {"amplitude_mm", xyz(1e3 * line.amplitude_m)}};
  if (line.family == MotionLine::Family::SIDEBAND) j["breaths"] = line.breaths;
  return j;
}

json axis_json(const servo::AxisAnalysis& a) {
  return {{"mean_mm", 1e3 * a.mean_m},
          {"rms_mm", 1e3 * a.rms_m},
          {"peak_to_peak_mm", 1e3 * a.peak_to_peak_m},
          {"respiration_peak_to_peak_mm", 1e3 * a.respiration_peak_to_peak_m},
          {"beat_peak_to_peak_mm", 1e3 * a.beat_peak_to_peak_m},
          {"noise_mm", 1e3 * a.noise_m},
          {"cutoff_hz", a.cutoff_hz},
          {"max_velocity_m_s", a.max_velocity},
          {"velocity_sigma_m_s", a.velocity_sigma},
          {"max_acceleration_m_s2", a.max_acceleration},
          {"acceleration_sigma_m_s2", a.acceleration_sigma},
          {"in_lines_percent", a.in_lines_percent}};
}

json found(const servo::MotionAnalysis& m) {
  const auto rate = [](double hz) { return hz > 0 ? json(hz) : json(nullptr); };
  json j{{"heart_hz", rate(m.rhythm.heart_hz)},
         {"respiration_hz", rate(m.rhythm.respiration_hz)},
         {"split_hz", m.split_hz},
         {"lines", json::array()}};
  for (const auto& line : m.lines) j["lines"].push_back(line_json(line));
  for (std::size_t a = 0; a < 3; ++a) j["axes"][kAxes[a]] = axis_json(m.axis[a]);
  return j;
}

// The line of the truth with the same name, or null.
json same_line(const json& truth, const json& line) {
  if (!truth.is_null())
    for (const json& other : truth["lines"])
      if (other["name"] == line["name"] && line["family"] != "other") return other;
  return nullptr;
}

ReportTable line_table(const json& summary) {
  const json& truth = summary["truth"];
  ReportTable table{"Lines", {"line", "Hz", "x %", "y %", "z %"}, {}, ""};
  if (!truth.is_null()) table.header.insert(table.header.end(), {"truth Hz", "x %", "y %", "z %"});
  const auto add = [](std::vector<std::string>& row, const json& line) {
    row.push_back(line.is_null() ? "-" : number(line["frequency_hz"], 3));
    for (const char* axis : kAxes) row.push_back(line.is_null() ? "-" : number(line["density_percent"][axis], 1));
  };
  for (const json& line : summary["lines"]) {
    table.rows.push_back({line["name"]});
    add(table.rows.back(), line);
    if (!truth.is_null()) add(table.rows.back(), same_line(truth, line));
  }
  table.note =
      "Density: the line's share of the power of all lines along the axis, as in the paper's Table 3. Harmonics lie at "
      "multiples of the mean rate; the power between two lines belongs to the nearer one.";
  return table;
}

ReportTable axis_table(const json& summary) {
  ReportTable table{"Axes", {"", "x", "y", "z"}, {}, ""};
  const json& truth = summary["truth"];
  const auto add = [&](const std::string& name, const json& from, const char* key, int decimals,
                       const char* sigma = nullptr) {
    table.rows.push_back({name});
    for (const char* axis : kAxes) {
      std::string cell = number(from["axes"][axis][key], decimals);
      if (sigma != nullptr) cell += " ± " + number(from["axes"][axis][sigma], decimals);
      table.rows.back().push_back(cell);
    }
  };
  const auto both = [&](const std::string& name, const char* key, int decimals, const char* sigma = nullptr) {
    add(name, summary, key, decimals, sigma);
    if (!truth.is_null()) add(name + ", truth", truth, key, decimals);
  };
  both("peak to peak mm", "peak_to_peak_mm", 2);
  both("respiration peak to peak mm", "respiration_peak_to_peak_mm", 2);
  both("beat peak to peak mm", "beat_peak_to_peak_mm", 2);
  both("RMS mm", "rms_mm", 3);
  both("largest velocity m/s", "max_velocity_m_s", 4, "velocity_sigma_m_s");
  both("largest acceleration m/s²", "max_acceleration_m_s2", 3, "acceleration_sigma_m_s2");
  add("cut-off Hz", summary, "cutoff_hz", 1);
  add("noise mm", summary, "noise_mm", 4);
  add("power in the lines %", summary, "in_lines_percent", 1);
  table.note = fmt::format(
      "Respiration: below {} Hz, by a Butterworth low-pass of order 10 run forwards and backwards; beat: the rest. "
      "Velocity and acceleration after the same kind of filter at the cut-off{}; ± is the standard deviation that the "
      "noise leaves in them. Noise: white, at the level of the spectrum's upper 30 %. The first and last {} s do not "
      "count for extremes.",
      number(summary["split_hz"], 2),
      summary["cutoff_given"].get<bool>() ? ""
                                          : ", which is where cutting signal away would begin to cost more than noise",
      number(summary["edge_s"], 1));
  return table;
}

}  // namespace

json analyse_summary(const AnalysisRun& run) {
  const servo::MotionAnalysis& m = run.measured;
  json j = found(m);
  j["command"] = "analyse";
  j["version"] = HEARTSERVO_VERSION;
  j["source"] = run.source;
  j["file"] = run.record.file;
  j["points"] = run.record.group;
  j["rows"] = run.record.time_s.size();
  j["duration_s"] = m.motion.duration_s();
  j["rate_hz"] = m.motion.rate_hz;
  j["interpolated_rows"] = m.motion.filled;
  j["spectrum"] = {{"segment_s", m.spectra[0].segment_s}, {"segments", m.spectra[0].segments}, {"window", "Hann"}};
  j["cutoff_given"] = run.options.cutoff_hz > 0;
  j["edge_s"] = run.options.edge_s;
  j["truth"] = run.truth ? found(*run.truth) : json(nullptr);
  j["notes"] = run.record.warnings;
  for (const auto& note : m.notes) j["notes"].push_back(note);
  return j;
}

std::vector<ReportTable> analyse_tables(const json& summary) { return {line_table(summary), axis_table(summary)}; }

}  // namespace heartservo::tools
