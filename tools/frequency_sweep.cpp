#include "tools/frequency_sweep.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "tools/servo_summary.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;
constexpr int kFrequencies = 9;
constexpr double kSettle_s = 8, kScored_s = 3;  // at least, and four periods; predictors learn the motion meanwhile
constexpr double kTau = 2 * std::numbers::pi;

json value(double v) { return std::isfinite(v) ? json(v) : json(); }

// First harmonic of y by least squares over 1, cos, sin.
std::complex<double> harmonic(double hz, std::span<const double> t, std::span<const double> y, double from_s) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t[i] < from_s || !std::isfinite(y[i])) continue;
    const Eigen::Vector3d row(1, std::cos(kTau * hz * t[i]), std::sin(kTau * hz * t[i]));
    A += row * row.transpose();
    b += row * y[i];
  }
  const Eigen::Vector3d x = A.ldlt().solve(b);
  return {x[1], -x[2]};  // Re(c e^{i w t})
}

double rms_around_mean(std::span<const double> t, std::span<const double> y, double from_s, bool around) {
  double sum = 0, squares = 0, n = 0;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (t[i] >= from_s && std::isfinite(y[i])) sum += y[i], squares += y[i] * y[i], ++n;
  const double mean = around ? sum / n : 0;
  return std::sqrt(std::max(0.0, squares / n - mean * mean));
}

}  // namespace

FrequencyPoint point_of(double hz, std::span<const double> t, std::span<const double> goal,
                        std::span<const double> residual, double settle_s) {
  FrequencyPoint p;
  p.hz = hz;
  p.S = -harmonic(hz, t, residual, settle_s) / harmonic(hz, t, goal, settle_s);
  p.left_percent = 100 * rms_around_mean(t, residual, settle_s, false) / rms_around_mean(t, goal, settle_s, true);
  return p;
}

Margins margins_of(const std::vector<FrequencyPoint>& points) {
  Margins m;
  m.gain_db = m.gain_at_hz = m.phase_deg = m.phase_at_hz = NAN;
  std::vector<double> gain_db, phase_deg;
  for (const auto& p : points) {
    if (std::abs(p.S) > m.worst_amplification) m.worst_amplification = std::abs(p.S), m.worst_at_hz = p.hz;
    const std::complex<double> L = (1.0 - p.S) / p.S;
    gain_db.push_back(20 * std::log10(std::abs(L)));
    double phase = std::arg(L) * 360 / kTau;
    const double before = phase_deg.empty() ? -90 : phase_deg.back();  // an integrator at low frequencies
    phase_deg.push_back(phase - 360 * std::round((phase - before) / 360));
  }
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto between = [&](double a, double b) { return a / (a - b); };  // where a line from a to b is 0
    const auto hz = [&](double x) { return points[i - 1].hz * std::pow(points[i].hz / points[i - 1].hz, x); };
    const auto mix = [&](const std::vector<double>& v, double x) { return v[i - 1] + x * (v[i] - v[i - 1]); };
    if (gain_db[i - 1] > 0 && gain_db[i] <= 0) {
      const double x = between(gain_db[i - 1], gain_db[i]);
      m.phase_at_hz = hz(x);
      m.phase_deg = 180 + mix(phase_deg, x);
    }
    if (phase_deg[i - 1] > -180 && phase_deg[i] <= -180 && std::isnan(m.gain_db)) {
      const double x = between(phase_deg[i - 1] + 180, phase_deg[i] + 180);
      m.gain_at_hz = hz(x);
      m.gain_db = -mix(gain_db, x);
    }
  }
  return m;
}

std::pair<double, double> parse_sweep(const std::string& text) {
  const auto colon = text.find(':');
  char* end = nullptr;
  const double low = std::strtod(text.c_str(), &end);
  const bool low_ok = colon != std::string::npos && end == text.c_str() + colon;
  const double high = low_ok ? std::strtod(text.c_str() + colon + 1, &end) : 0;
  if (!low_ok || *end != '\0' || !(low >= 0.05 && high <= 60 && low < high))
    throw ConfigError(fmt::format("--sweep-frequency {}: give LOW:HIGH in Hz, from 0.05 to 60, such as 0.2:10", text));
  return {low, high};
}

std::vector<double> sweep_frequencies(double low_hz, double high_hz, int count) {
  std::vector<double> hz;
  for (int i = 0; i < count; ++i) hz.push_back(low_hz * std::pow(high_hz / low_hz, i / (count - 1.0)));
  return hz;
}

FrequencySweep sweep(const ServoRequest& request, double low_hz, double high_hz,
                     const std::vector<std::string>& controllers) {
  if (request.scene.is_recorded()) throw ConfigError("--sweep-frequency needs a simulated scene");
  if (high_hz > 0.4 * request.scene.camera.frame_rate_hz)
    throw ConfigError(fmt::format("--sweep-frequency: {} Hz cannot be seen at {} frames per second", high_hz,
                                  request.scene.camera.frame_rate_hz));
  FrequencySweep result;
  for (const auto& controller : controllers) {
    std::vector<FrequencyPoint> points;
    json row{{"controller", controller}, {"predictor", request.scene.engines.predictor}, {"points", json::array()}};
    for (const double hz : sweep_frequencies(low_hz, high_hz, kFrequencies)) {
      ServoRequest one = request;
      one.scene.engines.controller = controller;
      one.scene.motion.profile = "sine";
      one.scene.motion.sine_hz = hz;
      if (one.scene.max_frames == 0) {
        one.scene.settle_s = kSettle_s;
        one.scene.duration_s = kSettle_s + std::max(kScored_s, 4 / hz);
      }
      one.scene.surface.strain = one.scene.surface.bulge_m = 0;
      one.label = fmt::format("{} {:.2f} Hz", controller, hz);
      result.last = run_loop(one);
      const TimeTable& t = result.last.frames;
      const std::string axis = std::string(1, "xyz"[one.scene.motion.sine_axis]) + "_m";
      points.push_back(point_of(hz, t.time_s(), t.column("goal/truth/" + axis), t.column("residual/" + axis),
                                result.last.scene.settle_s));
      const FrequencyPoint& p = points.back();
      row["points"].push_back({{"hz", hz},
                               {"left_percent", value(p.left_percent)},
                               {"gain", value(std::abs(p.S))},
                               {"phase_deg", value(std::arg(p.S) * 360 / kTau)},
                               {"stop_reason", result.last.summary["stop_reason"]}});
      if ((result.interrupted = result.last.interrupted)) return result;
    }
    const Margins m = margins_of(points);
    row["gain_margin_db"] = value(m.gain_db), row["gain_margin_hz"] = value(m.gain_at_hz);
    row["phase_margin_deg"] = value(m.phase_deg), row["phase_margin_hz"] = value(m.phase_at_hz);
    row["worst_amplification"] = value(m.worst_amplification), row["worst_hz"] = value(m.worst_at_hz);
    result.rows.push_back(row);
  }
  return result;
}

ReportTable sweep_table(const json& rows) {
  ReportTable table{"Residual against a sine of each frequency, % of the target's motion",
                    {"Hz"},
                    {},
                    "Margins are those of the loop with unity feedback that would leave the same: L = (1 - S) / S, S "
                    "the residual over the target's motion; - where nothing crosses between the frequencies."};
  for (const auto& row : rows) table.header.push_back(row["controller"].get<std::string>());
  if (rows.empty()) return table;
  for (std::size_t i = 0; i < rows[0]["points"].size(); ++i) {
    std::vector<std::string> cells{number(rows[0]["points"][i]["hz"], 2)};
    for (const auto& row : rows) cells.push_back(number(row["points"][i]["left_percent"], 1));
    table.rows.push_back(cells);
  }
  const auto line = [&](const std::string& name, const char* key, const char* at, int decimals) {
    std::vector<std::string> cells{name};
    for (const auto& row : rows)
      cells.push_back(row[key].is_null() ? "-"
                                         : fmt::format("{} @ {} Hz", number(row[key], decimals), number(row[at], 1)));
    table.rows.push_back(cells);
  };
  line("gain margin, dB", "gain_margin_db", "gain_margin_hz", 1);
  line("phase margin, deg", "phase_margin_deg", "phase_margin_hz", 0);
  line("worst |S|", "worst_amplification", "worst_hz", 2);
  return table;
}

std::string sweep_text(const json& rows) {
  const ReportTable table = sweep_table(rows);
  std::string text = table.title + "\n\n";
  const auto line = [&](const std::vector<std::string>& c) {
    text += fmt::format("{:<20}", c[0]);
    for (std::size_t i = 1; i < c.size(); ++i) text += fmt::format("{:>20}", c[i]);
    text += "\n";
  };
  line(table.header);
  for (const auto& row : table.rows) line(row);
  return text;
}

}  // namespace heartservo::tools
