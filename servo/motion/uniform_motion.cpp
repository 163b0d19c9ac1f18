#include "servo/motion/uniform_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tracking/settings/errors.hpp"

namespace heartservo::servo {

namespace {

// Slope at known row k: of the parabola through it and its neighbours (one-sided at the ends).
Eigen::Vector3d slope(const std::vector<double>& t, const std::vector<Eigen::Vector3d>& p, std::size_t k) {
  const auto secant = [&](std::size_t i) -> Eigen::Vector3d { return (p[i + 1] - p[i]) / (t[i + 1] - t[i]); };
  if (k == 0) return secant(0);
  if (k + 1 == t.size()) return secant(k - 1);
  const double before = t[k] - t[k - 1], after = t[k + 1] - t[k];
  return (after * secant(k - 1) + before * secant(k)) / (before + after);
}

}  // namespace

UniformMotion uniform_motion(const MotionRecord& record, const std::vector<Eigen::Vector3d>& positions) {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> p;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (positions[i].hasNaN()) continue;
    if (!t.empty() && record.time_s[i] - t.back() > kLongestBridge_s + record.period_s())
      throw InputError(
          fmt::format("{}:{}: {:.3g} s without a position before {:.6g} s; gaps up to {} s are bridged: give "
                      "a stretch without this one",
                      record.file, record.line[i], record.time_s[i] - t.back(), record.time_s[i], kLongestBridge_s));
    t.push_back(record.time_s[i]);
    p.push_back(positions[i]);
  }
  if (t.size() < 4)
    throw InputError(fmt::format("{}:{}: only {} rows have a position", record.file, record.line.front(), t.size()));

  UniformMotion motion;
  const double period = record.period_s();
  motion.start_s = t.front();
  motion.rate_hz = 1 / period;
  const auto count = static_cast<std::size_t>(std::floor((t.back() - t.front()) / period + 1e-3)) + 1;
  for (auto& axis : motion.axis) axis.reserve(count);
  std::size_t k = 0;  // the known row at or before the sample
  for (std::size_t i = 0; i < count; ++i) {
    const double at = t.front() + static_cast<double>(i) * period;
    while (k + 2 < t.size() && t[k + 1] <= at) ++k;
    const double step = t[k + 1] - t[k], u = std::clamp((at - t[k]) / step, 0.0, 1.0);
    if (step > 1.5 * period && u > 1e-6 && u < 1 - 1e-6) ++motion.filled;
    const Eigen::Vector3d value = (1 + 2 * u) * (1 - u) * (1 - u) * p[k] + u * u * (3 - 2 * u) * p[k + 1] +
                                  step * u * (1 - u) * ((1 - u) * slope(t, p, k) - u * slope(t, p, k + 1));
    for (int a = 0; a < 3; ++a) motion.axis[static_cast<std::size_t>(a)].push_back(value[a]);
  }
  return motion;
}

}  // namespace heartservo::servo
