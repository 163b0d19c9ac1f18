#include "tools/analyse_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/servo_summary.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;
using Series = std::array<std::vector<double>, 3>;

constexpr const char* kAxes[] = {"x", "y", "z"};

// Columns NAME/x_UNIT ... of `series`, where they are as long as the table.
struct Columns {
  std::vector<std::string> names;
  std::vector<const std::vector<double>*> values;

  void add(const std::string& name, const std::string& unit, const Series& series) {
    for (std::size_t a = 0; a < 3; ++a) {
      names.push_back(fmt::format("{}/{}_{}", name, kAxes[a], unit));
      values.push_back(&series[a]);
    }
  }
  TimeTable table(const std::string& first, std::size_t rows, const std::function<double(std::size_t)>& x) const {
    std::vector<std::string> all{first};
    all.insert(all.end(), names.begin(), names.end());
    TimeTable table(all, rows);
    std::vector<double> row(all.size());
    for (std::size_t i = 0; i < rows; ++i) {
      row[0] = x(i);
      for (std::size_t c = 0; c < values.size(); ++c) row[c + 1] = i < values[c]->size() ? (*values[c])[i] : NAN;
      table.append(row);
    }
    return table;
  }
};

Series densities(const servo::MotionAnalysis& m) {
  return {m.spectra[0].density, m.spectra[1].density, m.spectra[2].density};
}

// Places about their means, so that all three fit one plot.
ReportPlot over_time(const std::string& title, const std::string& column, const std::string& unit,
                     const std::string& shown, double scale, bool truth, const std::string& note) {
  ReportPlot plot{title, shown, {}, scale, note};
  if (truth) plot.series.push_back({"truth z", fmt::format("truth/{}/z_{}", column, unit), true});
  for (const char* axis : {"z", "x", "y"}) plot.series.push_back({axis, fmt::format("{}/{}_{}", column, axis, unit)});
  plot.about_mean = column == "respiration" || column == "position";
  return plot;
}

void answer(Report& report, const json& s) {
  const auto rate = [](const json& hz, const char* name) {
    return hz.is_null() ? fmt::format("no {} found", name)
                        : fmt::format("{} {} Hz ({} a minute)", name, number(hz, 3), number(60 * hz.get<double>(), 1));
  };
  const json& z = s["axes"]["z"];
  report.headline = fmt::format(
      "{}, {}. Along z {} mm peak to peak, {} mm of it respiration; acceleration up to {} ± {} m/s² below {} Hz.",
      rate(s["heart_hz"], "heartbeat"), rate(s["respiration_hz"], "respiration"), number(z["peak_to_peak_mm"], 1),
      number(z["respiration_peak_to_peak_mm"], 1), number(z["max_acceleration_m_s2"], 2),
      number(z["acceleration_sigma_m_s2"], 2), number(z["cutoff_hz"], 1));
  report.headline[0] = static_cast<char>(std::toupper(report.headline[0]));
  report.headline_number = number(z["max_acceleration_m_s2"], 2);
  report.headline_unit = "m/s² largest acceleration along z";
  for (const json& note : s["notes"]) report.notices.push_back(note);
}

}  // namespace

TimeTable motion_table(const AnalysisRun& run) {
  Columns columns;
  const auto add = [&](const std::string& group, const servo::MotionAnalysis& m) {
    columns.add(group + "position", "m", m.motion.axis);
    columns.add(group + "respiration", "m", m.respiration);
    columns.add(group + "beat", "m", m.beat);
    columns.add(group + "velocity", "m_s", m.velocity);
    columns.add(group + "acceleration", "m_s2", m.acceleration);
  };
  add("", run.measured);
  if (run.truth) add("truth/", *run.truth);
  const auto& motion = run.measured.motion;
  return columns.table("time_s", motion.size(), [&](std::size_t i) { return motion.time_s(i); });
}

TimeTable spectrum_table(const AnalysisRun& run) {
  const Series measured = densities(run.measured);
  const Series truth = run.truth ? densities(*run.truth) : Series{};
  Columns columns;
  columns.add("density", "m2_hz", measured);
  if (run.truth) columns.add("truth/density", "m2_hz", truth);
  const auto& spectrum = run.measured.spectra[0];
  double highest = 8;  // Hz, that has anything to show
  for (const auto& axis : run.measured.axis) highest = std::max(highest, 1.5 * axis.cutoff_hz);
  const auto rows = std::min(spectrum.density.size(), static_cast<std::size_t>(highest / spectrum.step_hz));
  return columns.table("frequency_hz", rows, [&](std::size_t i) { return spectrum.frequency_hz(i); });
}

Report analyse_report(const AnalysisRun& run, const json& summary, const TimeTable& motion, const TimeTable& spectrum,
                      const std::string& config_yaml) {
  Report report;
  report.title = "analyse " + run.source;
  answer(report, summary);
  const bool truth = run.truth.has_value();
  const double split = run.measured.split_hz;
  ReportPlot density =
      over_time("Power spectral density", "density", "m2_hz", "mm²/Hz", 1e6, truth,
                fmt::format("Welch, Hann window, {} segment{} of {:.1f} s.", run.measured.spectra[0].segments,
                            run.measured.spectra[0].segments == 1 ? "" : "s", run.measured.spectra[0].segment_s));
  density.table = &spectrum;
  double highest = 0;
  for (const char* axis : kAxes)
    for (const double d : spectrum.column(fmt::format("density/{}_m2_hz", axis))) highest = std::max(highest, d);
  density.log_from = 1e6 * highest * 1e-7;
  report.plots = {
      over_time("Beat", "beat", "m", "mm", 1e3, truth, fmt::format("What lies above {:.2f} Hz.", split)),
      density,
      over_time("Respiration", "respiration", "m", "mm", 1e3, truth, fmt::format("What lies below {:.2f} Hz, about its mean.", split)),
      over_time("Velocity", "velocity", "m_s", "mm/s", 1e3, truth, ""),
      over_time("Acceleration", "acceleration", "m_s2", "m/s²", 1, truth, ""),
      over_time("Position", "position", "m", "mm", 1e3, truth, "Camera frame, about the mean."),
  };
  report.tables = analyse_tables(summary);
  report.table = &motion;
  report.config_yaml = config_yaml;
  report.summary = summary;
  return report;
}

}  // namespace heartservo::tools
