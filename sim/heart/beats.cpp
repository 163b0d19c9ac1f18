#include "sim/heart/beats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

/// Integral from 0 to x of the step 10 x^3 - 15 x^4 + 6 x^5, whose first two derivatives vanish at both ends.
double step_integral(double x) { return x * x * x * x * (2.5 + x * (x - 3)); }

/// Integral from 0 to u of a window on [0, 1] that rises over `ramp`, stays 1 and falls over `ramp`.
double window_integral(double u, double ramp) {
  if (u < ramp) return ramp * step_integral(u / ramp);
  if (u < 1 - ramp) return u - ramp / 2;
  return 1 - ramp - ramp * step_integral((1 - u) / ramp);
}

}  // namespace

std::vector<double> cycle_marks(const CycleStatistics& statistics, double duration_s, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double mean = 1 / statistics.rate_hz;
  const double innovation = std::sqrt(1 - statistics.correlation * statistics.correlation);
  double deviation = normal(random);
  std::vector<double> marks{-mean * std::uniform_real_distribution<double>(0, 0.999)(random)};
  while (marks.back() <= duration_s) {
    const double relative = statistics.variability * std::clamp(deviation, -4.0, 4.0);
    marks.push_back(marks.back() + mean * std::max(0.5, 1 + relative));
    deviation = statistics.correlation * deviation + innovation * normal(random);
  }
  return marks;
}

std::vector<double> with_ectopic_beats(std::vector<double> marks, double share, double advance, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> chance;
  bool early = true;
  for (std::size_t i = 1; i + 2 < marks.size(); ++i) {
    const double drawn = chance(random);
    early = !early && drawn < share;
    if (early) marks[i] -= advance * (marks[i] - marks[i - 1]);
  }
  return marks;
}

std::vector<double> plausible_beats(std::vector<double> r_peaks_s) {
  std::sort(r_peaks_s.begin(), r_peaks_s.end());
  std::vector<double> beats;
  for (const double peak : r_peaks_s)
    if (beats.empty() || peak - beats.back() > kSystole_s + 0.1) beats.push_back(peak);
  return beats;
}

PhaseClock::PhaseClock(std::vector<double> marks_s, double nominal_period_s, double fixed_s)
    : marks_(std::move(marks_s)), nominal_s_(nominal_period_s), fixed_s_(fixed_s) {
  if (!(fixed_s >= 0 && fixed_s < nominal_period_s))
    throw ConfigError(fmt::format("cycle period {} s must exceed its fixed part {} s", nominal_period_s, fixed_s));
  if (marks_.empty()) marks_.push_back(0);
  for (std::size_t i = 1; i < marks_.size(); ++i)
    if (!(marks_[i] - marks_[i - 1] > fixed_s))
      throw ConfigError(fmt::format("cycle at {} s is shorter than its fixed part {} s", marks_[i - 1], fixed_s));
}

double PhaseClock::phase(double t) const {
  if (t < marks_.front() || t >= marks_.back()) {
    const double cycles = (t - (t < marks_.front() ? marks_.front() : marks_.back())) / nominal_s_;
    return cycles - std::floor(cycles);
  }
  const auto next = std::upper_bound(marks_.begin(), marks_.end(), t);
  const double since = t - *(next - 1);
  if (since <= fixed_s_) return since / nominal_s_;
  const double stretched = *next - *(next - 1) - fixed_s_;
  // The rate after the fixed part is (1 - c window(u)) / nominal. The window's ramps take a quarter of the time
  // each, less in very long cycles, so that c stays below 0.95 and the phase never stands still or runs backwards.
  const double missing = 1 - (nominal_s_ - fixed_s_) / stretched;
  const double ramp = std::min(0.25, 1 - missing / 0.95);
  const double c = missing / (1 - ramp);
  const double u = (since - fixed_s_) / stretched;
  const double phase = (fixed_s_ + stretched * (u - c * window_integral(u, ramp))) / nominal_s_;
  return phase < 1 ? phase : 0;
}

}  // namespace heartservo::sim
