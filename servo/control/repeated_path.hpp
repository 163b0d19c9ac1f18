#pragma once
// A path that nearly repeats itself, foreseen from its own past: the disturbance model of repetitive generalised
// predictive control. Ginhoux, Gangloff, de Mathelin, Soler, Arenas Sanchez, Marescaux (IEEE T-RO 2005) take the period
// as known; here it is the lag at which the last quarter of a second is most like what was before, so that it follows
// beats of varying length. Ahead of now the path goes on as it did one period ago:
//
//   w(t + s) = w(t) + w(t + s - n) - w(t - n),
//
// the disturbance of the model (1 - q^-1)(1 - q^-n) w = noise. Nothing is allocated.
#include <Eigen/Core>
#include <array>

namespace heartservo::servo {

class RepeatedPath {
 public:
  /// Periods from shortest to longest (s) are looked for.
  RepeatedPath(double sample_s, double shortest_s = 0.45, double longest_s = 1.7);

  /// One sample a period of the camera, m; what is not finite counts as the path's own forecast.
  void add(const Eigen::Vector3d& position);

  /// False until two of the longest periods were seen, or while nothing repeats.
  bool known() const { return period_ > 0; }
  double period_s() const { return period_ * sample_s_; }

  /// `ahead_s` after the newest sample, up to the shortest period.
  Eigen::Vector3d at(double ahead_s) const;

 private:
  static constexpr std::size_t kMemory = 2048;
  const Eigen::Vector3d& past(std::size_t samples_ago) const {
    return samples_[(count_ - 1 - samples_ago) % kMemory];
  }
  Eigen::Vector3d past(double samples_ago) const;
  double unlikeness(std::size_t lag, std::size_t samples) const;
  void find_period();

  double sample_s_;
  std::size_t shortest_, longest_, way_, window_;
  std::array<Eigen::Vector3d, kMemory> samples_;
  std::array<double, kMemory> cost_{};
  std::size_t count_ = 0;
  double period_ = 0;  // samples; 0: not known
};

}  // namespace heartservo::servo
