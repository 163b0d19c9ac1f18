#include "tracking/landmark/side_filter.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
}

std::vector<std::string> SideFilterOptions::validate() const {
  std::vector<std::string> problems;
  if (!(motion_sigma > 0)) problems.emplace_back("motion_sigma must be positive");
  if (!(jump > 0 && jump < 1)) problems.emplace_back("jump must lie between 0 and 1");
  if (!(memory_s >= 0)) problems.emplace_back("memory_s must not be negative");
  if (!(most_odds > 0)) problems.emplace_back("most_odds must be positive");
  if (!(smoothing >= 0 && smoothing < 1)) problems.emplace_back("smoothing must lie in 0..1, below 1");
  return problems;
}

SideFilter::SideFilter(const SideFilterOptions& options) : options_(options) {
  const auto problems = options.validate();
  if (!problems.empty()) throw ConfigError(fmt::format("side filter: {}", fmt::join(problems, "; ")));
}

void SideFilter::continue_from(const Memory& before, double rotation_sigma, Memory& now) const {
  const double variance = options_.motion_sigma * options_.motion_sigma + 2.25 * rotation_sigma * rotation_sigma;
  std::array<std::array<double, 2>, 2> cost;  // [side now][side before], angle squared
  std::array<double, 2> least{kInfinity, kInfinity};
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const double angle = before.sides[j].rotation.angularDistance(now.sides[i].rotation);
      cost[i][j] = angle * angle;
      if (std::isfinite(now.sides[i].log_probability)) least[j] = std::min(least[j], cost[i][j]);
    }
  for (int i = 0; i < 2; ++i) {
    Hypothesis& side = now.sides[i];
    if (!std::isfinite(side.log_probability)) continue;
    double likeliest = -kInfinity;
    int from = 0;
    for (int j = 0; j < 2; ++j) {
      const double further = (cost[i][j] - least[j]) / (2 * variance);
      const double log_p = before.sides[j].log_probability + std::max(-further, std::log(options_.jump));
      if (!(log_p > likeliest)) continue;
      likeliest = log_p;
      from = j;
    }
    if (!std::isfinite(likeliest)) continue;
    side.log_probability += likeliest;
    // After a jump its old rotation says nothing.
    if (cost[i][from] < 9 * variance)
      side.rotation = side.rotation.slerp(options_.smoothing, before.sides[from].rotation);
  }
}

SideFilter::Memory SideFilter::next(double time_s, const Rotations& rotations,
                                    const std::array<double, 2>& chi2, double rotation_sigma) const {
  Memory now{time_s, {}};
  const bool remembers = memory_ && time_s >= memory_->time_s && time_s - memory_->time_s < options_.memory_s;
  for (int i = 0; i < 2; ++i) {
    const bool solved = std::isfinite(chi2[i]) && rotations[i].allFinite();
    now.sides[i].rotation = solved ? Eigen::Quaterniond(rotations[i]) : Eigen::Quaterniond::Identity();
    now.sides[i].log_probability = solved ? -0.5 * chi2[i] : -kInfinity;
  }
  if (remembers) continue_from(*memory_, rotation_sigma, now);
  const double best = std::max(now.sides[0].log_probability, now.sides[1].log_probability);
  if (!std::isfinite(best)) return now;
  for (Hypothesis& side : now.sides)
    if (std::isfinite(side.log_probability))
      side.log_probability = std::max(side.log_probability - best, -options_.most_odds);
  return now;
}

std::array<double, 2> SideFilter::log_probabilities(double time_s, const Rotations& rotations,
                                                    const std::array<double, 2>& chi2, double rotation_sigma) const {
  const Memory now = next(time_s, rotations, chi2, rotation_sigma);
  return {now.sides[0].log_probability, now.sides[1].log_probability};
}

std::array<double, 2> SideFilter::keep(double time_s, const Rotations& rotations, const std::array<double, 2>& chi2,
                                       double rotation_sigma) {
  if (memory_ && time_s < memory_->time_s) memory_.reset();
  const Memory now = next(time_s, rotations, chi2, rotation_sigma);
  const std::array<double, 2> log_p{now.sides[0].log_probability, now.sides[1].log_probability};
  if (std::isfinite(log_p[0]) || std::isfinite(log_p[1])) memory_ = now;
  return log_p;
}

}  // namespace heartservo::tracking
