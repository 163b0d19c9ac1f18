#pragma once
// The loop against a sine: what is left of each frequency, and the margins of the loop that this amounts to.
#include <complex>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tools/report/report.hpp"
#include "tools/servo_run.hpp"

namespace heartservo::tools {

/// Residual over target motion at one frequency: S = (goal - tip) / goal, complex.
struct FrequencyPoint {
  double hz = 0;
  std::complex<double> S;
  double left_percent = 0;  ///< RMS of the whole residual, noise included, against the target's motion
};

/// Margins of the open loop L = (1 - S) / S of an equivalent loop with unity feedback, between the frequencies given;
/// NaN where no crossing lies between them. The gain margin is the factor by which L may grow where its phase is -180
/// degrees; the phase margin what its phase may lose where its gain falls through 1.
struct Margins {
  double gain_db = 0, gain_at_hz = 0, phase_deg = 0, phase_at_hz = 0;
  double worst_amplification = 0;  ///< largest |S|
  double worst_at_hz = 0;
};
Margins margins_of(const std::vector<FrequencyPoint>& points);

/// `residual` (tip - goal) and `goal` along the sine, m, at times `t`: the first harmonic of each by least squares.
FrequencyPoint point_of(double hz, std::span<const double> t, std::span<const double> goal,
                        std::span<const double> residual, double settle_s);

/// "0.2:10" -> the two numbers. Throws ConfigError.
std::pair<double, double> parse_sweep(const std::string& text);

/// `count` frequencies from low to high, equally spaced on a logarithmic axis.
std::vector<double> sweep_frequencies(double low_hz, double high_hz, int count);

struct FrequencySweep {
  nlohmann::json rows = nlohmann::json::array();  ///< a row a controller: points and margins
  bool interrupted = false;
  ServoOutcome last;
};
FrequencySweep sweep(const ServoRequest& request, double low_hz, double high_hz,
                     const std::vector<std::string>& controllers);

std::string sweep_text(const nlohmann::json& rows);
ReportTable sweep_table(const nlohmann::json& rows);

}  // namespace heartservo::tools
