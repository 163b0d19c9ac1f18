#include "servo/control/repeated_path.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::servo {

namespace {

constexpr double kWindow_s = 0.3;
constexpr double kWay_s = 0.04;
constexpr double kNear = 0.12;  // from one sample to the next the period is looked for this near to the last one
constexpr int kAnew = 64;       // and every so many samples everywhere

}  // namespace

RepeatedPath::RepeatedPath(double sample_s, double shortest_s, double longest_s)
    : sample_s_(sample_s),
      shortest_(std::max<std::size_t>(6, static_cast<std::size_t>(shortest_s / sample_s))),
      longest_(
          std::clamp<std::size_t>(static_cast<std::size_t>(longest_s / sample_s), shortest_ + 4, kMemory / 2 - 200)),
      way_(std::max<std::size_t>(1, static_cast<std::size_t>(kWay_s / sample_s))),
      window_(std::max<std::size_t>(4, static_cast<std::size_t>(kWindow_s / sample_s))) {
  samples_.fill(Eigen::Vector3d::Zero());
}

void RepeatedPath::add(const Eigen::Vector3d& position) {
  const Eigen::Vector3d sample = position.allFinite() ? position : count_ > 0 ? at(sample_s_) : position;
  if (!sample.allFinite()) return;
  samples_[count_ % kMemory] = sample;
  ++count_;
  if (count_ > 2 * longest_ + way_) find_period();
}

Eigen::Vector3d RepeatedPath::past(double samples_ago) const {
  const double whole = std::floor(samples_ago), part = samples_ago - whole;
  const auto i = static_cast<std::size_t>(whole);
  return (1 - part) * past(i) + part * past(i + 1);
}

// Mean squared difference of the short ways gone in the last samples and those gone `lag` samples earlier. Short ways,
// because the breath is slow and does not repeat with the beat.
double RepeatedPath::unlikeness(std::size_t lag, std::size_t samples) const {
  double sum = 0;
  for (std::size_t i = 0; i < samples; ++i)
    sum += ((past(i) - past(i + way_)) - (past(i + lag) - past(i + lag + way_))).squaredNorm();
  return sum / static_cast<double>(samples);
}

void RepeatedPath::find_period() {
  std::size_t low = shortest_, high = longest_;
  // anew: over a whole longest period, so that a slow breath does not pass for a beat
  const bool anew = count_ % kAnew == 0;
  if (!anew && period_ <= 0) return;
  if (anew) {
    double least = INFINITY, most = 0;
    for (std::size_t n = low; n <= high; ++n) {
      cost_[n] = unlikeness(n, longest_);
      least = std::min(least, cost_[n]), most = std::max(most, cost_[n]);
    }
    period_ = 0;
    if (!(least < 0.5 * most)) return;  // nothing repeats
    const double good = least + 0.1 * (most - least);
    for (std::size_t n = low + 1; n < high && period_ <= 0; ++n)  // the first valley: others are multiples of it
      if (cost_[n] <= good && cost_[n] <= cost_[n - 1] && cost_[n] <= cost_[n + 1]) period_ = static_cast<double>(n);
    if (period_ <= 0) return;
  }
  low = std::max(shortest_, static_cast<std::size_t>(period_ * (1 - kNear)));
  high = std::min(longest_, static_cast<std::size_t>(period_ * (1 + kNear)));
  for (std::size_t n = low; n <= high; ++n) cost_[n] = unlikeness(n, window_);
  const std::size_t n =
      static_cast<std::size_t>(std::min_element(cost_.begin() + static_cast<std::ptrdiff_t>(low),
                                                cost_.begin() + static_cast<std::ptrdiff_t>(high) + 1) -
                               cost_.begin());
  period_ = static_cast<double>(n);
  if (n > low && n < high) {  // vertex of the parabola through the three lowest
    const double bend = cost_[n - 1] - 2 * cost_[n] + cost_[n + 1];
    if (bend > 0) period_ += std::clamp(0.5 * (cost_[n - 1] - cost_[n + 1]) / bend, -0.5, 0.5);
  }
}

Eigen::Vector3d RepeatedPath::at(double ahead_s) const {
  if (count_ == 0) return Eigen::Vector3d::Constant(NAN);
  const double ahead = ahead_s / sample_s_;
  if (!known() || ahead >= period_) return past(std::size_t{0});
  return past(std::size_t{0}) + past(period_ - ahead) - past(period_);
}

}  // namespace heartservo::servo
