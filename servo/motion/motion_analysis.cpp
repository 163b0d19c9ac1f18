#include "servo/motion/motion_analysis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "servo/motion/zero_phase.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::servo {

namespace {

constexpr double kTau = 2 * std::numbers::pi;

// Values of a series away from its ends.
std::span<const double> inside(const std::vector<double>& series, double edge_s, double rate_hz) {
  const auto edge = std::min(static_cast<std::size_t>(std::lround(edge_s * rate_hz)), (series.size() - 1) / 4);
  return std::span(series).subspan(edge, series.size() - 2 * edge);
}

double peak_to_peak(std::span<const double> values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

double largest(std::span<const double> values) {
  double largest = 0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

// Less is rounding: a nanometre.
constexpr double kStill_m = 1e-9;

// The cut-off that leaves the acceleration the smallest error: signal that is cut away above it, noise that passes
// below it, both by the spectrum (averaged over half a hertz, since single values scatter).
double best_cutoff(const Spectrum& spectrum, double noise) {
  const double step = spectrum.step_hz, half_rate = spectrum.frequency_hz(spectrum.density.size() - 1);
  const auto half = static_cast<std::size_t>(std::lround(0.25 / step));
  std::vector<double> sums{0};
  for (const double d : spectrum.density) sums.push_back(sums.back() + d);
  double error = 0, best = 0;
  std::size_t best_at = 0;
  for (std::size_t i = 1; i < spectrum.density.size(); ++i) {
    const std::size_t from = i > half ? i - half : 0, to = std::min(i + half + 1, spectrum.density.size());
    const double density = (sums[to] - sums[from]) / static_cast<double>(to - from);
    const double weight = std::pow(kTau * spectrum.frequency_hz(i), 4) * step;
    error += weight * (noise - std::max(density - noise, 0.0));  // this value passes instead of being cut away
    if (error < best) best = error, best_at = i;
  }
  // the filter is already falling somewhat below its cut-off
  return std::clamp(1.15 * spectrum.frequency_hz(best_at), 2.0, 0.8 * half_rate);
}

// Standard deviation of the `derivative`th derivative of white noise after the filter.
double passed_noise(double noise, double half_rate, const ZeroPhaseLowPass& filter, int derivative) {
  constexpr int kSteps = 4000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double f = half_rate * (i + 0.5) / kSteps;
    sum += std::pow(kTau * f, 2 * derivative) * std::pow(filter.gain(f), 2) * half_rate / kSteps;
  }
  return std::sqrt(noise * sum);
}

double chosen_split(const Rhythm& rhythm, const AnalysisOptions& options, std::vector<std::string>& notes) {
  if (options.split_hz > 0) return options.split_hz;
  // 1 Hz as in the paper, as long as the heart's line is safely above it
  if (rhythm.heart_hz == 0 || rhythm.heart_hz > 1.12) return 1;
  const double split = std::max(0.85 * rhythm.heart_hz, 1.1 * rhythm.respiration_hz);
  notes.push_back(fmt::format("the heart beats at {:.2f} Hz, so respiration is split off at {:.2f} Hz instead of 1 Hz",
                              rhythm.heart_hz, split));
  return split;
}

void analyse_axis(MotionAnalysis& m, std::size_t a, const AnalysisOptions& options) {
  const auto& series = m.motion.axis[a];
  const double rate = m.motion.rate_hz, half_rate = 0.5 * rate;
  AxisAnalysis& axis = m.axis[a];
  for (const double v : series) axis.mean_m += v / static_cast<double>(series.size());
  for (const double v : series)
    axis.rms_m += (v - axis.mean_m) * (v - axis.mean_m) / static_cast<double>(series.size());
  axis.rms_m = std::sqrt(axis.rms_m);
  axis.peak_to_peak_m = peak_to_peak(series);
  axis.noise_density = noise_density(m.spectra[a]);
  axis.noise_m = std::sqrt(axis.noise_density * half_rate);
  axis.cutoff_hz = options.cutoff_hz > 0 ? options.cutoff_hz : best_cutoff(m.spectra[a], axis.noise_density);
  const ZeroPhaseLowPass filter{axis.cutoff_hz};
  m.respiration[a] = low_pass(series, rate, {m.split_hz});
  m.beat[a] = low_pass(series, rate, filter);
  for (std::size_t i = 0; i < series.size(); ++i) m.beat[a][i] -= m.respiration[a][i];
  m.velocity[a] = low_pass(series, rate, filter, 1);
  m.acceleration[a] = low_pass(series, rate, filter, 2);
  const auto middle = [&](const std::vector<double>& values) { return inside(values, options.edge_s, rate); };
  axis.respiration_peak_to_peak_m = peak_to_peak(middle(m.respiration[a]));
  axis.beat_peak_to_peak_m = peak_to_peak(middle(m.beat[a]));
  axis.max_velocity = largest(middle(m.velocity[a]));
  axis.max_acceleration = largest(middle(m.acceleration[a]));
  axis.velocity_sigma = passed_noise(axis.noise_density, half_rate, filter, 1);
  axis.acceleration_sigma = passed_noise(axis.noise_density, half_rate, filter, 2);
}

void require_motion(const MotionRecord& record, const UniformMotion& motion) {
  if (motion.duration_s() < kShortestRecord_s)
    throw InputError(fmt::format("{}: {:.3g} s of motion; a spectrum that tells breaths from beats needs {} s",
                                 record.file, motion.duration_s(), kShortestRecord_s));
  if (motion.rate_hz < 10)
    throw InputError(
        fmt::format("{}: {:.3g} rows a second; a heart's motion needs 10 or more", record.file, motion.rate_hz));
  if (std::all_of(motion.axis.begin(), motion.axis.end(),
                  [](const auto& axis) { return peak_to_peak(axis) < kStill_m; }))
    throw InputError(fmt::format("{}:{}: the position is the same in every row: there is no motion to analyse",
                                 record.file, record.line.front()));
}

}  // namespace

std::vector<std::string> AnalysisOptions::validate() const {
  std::vector<std::string> problems;
  if (!(segment_s >= 2)) problems.emplace_back("segments of the spectrum must be 2 s or longer");
  if (!(split_hz >= 0 && cutoff_hz >= 0)) problems.emplace_back("frequencies must not be negative");
  if (cutoff_hz > 0 && split_hz > cutoff_hz) problems.emplace_back("the split lies above the cut-off");
  if (!(edge_s >= 0)) problems.emplace_back("edge_s must not be negative");
  return problems;
}

MotionAnalysis analyse(const MotionRecord& record, const std::vector<Eigen::Vector3d>& positions,
                       const AnalysisOptions& options) {
  MotionAnalysis m;
  m.motion = uniform_motion(record, positions);
  require_motion(record, m.motion);
  if (options.cutoff_hz > 0.45 * m.motion.rate_hz)
    throw ConfigError(fmt::format("a cut-off of {} Hz is too high for {}: {:.4g} rows a second hold up to {:.4g} Hz",
                                  options.cutoff_hz, record.file, m.motion.rate_hz, 0.45 * m.motion.rate_hz));
  for (std::size_t a = 0; a < 3; ++a) {
    auto& axis = m.motion.axis[a];
    const bool still = peak_to_peak(axis) < kStill_m;
    if (still) std::fill(axis.begin(), axis.end(), axis[0]);
    m.spectra[a] = welch(axis, m.motion.rate_hz, options.segment_s);
    if (still) std::fill(m.spectra[a].density.begin(), m.spectra[a].density.end(), 0.0);
  }
  m.rhythm = find_rhythm(m.motion, m.spectra);
  for (const auto& [name, f] : {std::pair("heartbeat", m.rhythm.heart_hz), {"breathing", m.rhythm.respiration_hz}})
    if (f == 0) m.notes.push_back(fmt::format("no line that could be the {} stands out", name));
  m.split_hz = chosen_split(m.rhythm, options, m.notes);
  for (std::size_t a = 0; a < 3; ++a) analyse_axis(m, a, options);
  const Eigen::Vector3d noise(m.axis[0].noise_density, m.axis[1].noise_density, m.axis[2].noise_density);
  m.lines = find_lines(m.rhythm, m.spectra, noise, options.least_percent);
  for (std::size_t a = 0; a < 3; ++a) {
    double in_lines = 0;
    for (const auto& line : m.lines) in_lines += 0.5 * std::pow(line.amplitude_m[static_cast<Eigen::Index>(a)], 2);
    const double total = m.spectra[a].power(0, INFINITY);
    m.axis[a].in_lines_percent = total > 0 ? 100 * in_lines / total : 0;
  }
  if (m.motion.filled > 0)
    m.notes.push_back(fmt::format("{} of {} samples were interpolated over gaps", m.motion.filled, m.motion.size()));
  return m;
}

}  // namespace heartservo::servo
