#pragma once
// Which of the two poses of a planar square is real (refined_pose.hpp), decided over time. Four corners seen once leave
// the side open when the tilt is small against their noise; but a plate does not jump from one side to the other between
// two frames, so that each frame's small evidence adds up. A forward filter with two hypotheses, one per solution:
//
//   log p(i, k) = -chi2(i, k) / 2 + max over j of [ log p(j, k-1) + log max(jump, exp(-(a(i, j)^2 - a(j)^2) / (2 s^2))) ]
//
// s^2 = motion^2 + (1.5 sigma)^2, sigma that of the solutions' rotation: the smoothed one has its own share of noise.
// a(i, j): angle from the rotation that hypothesis j had, smoothed, to that of solution i; a(j): the smaller one of j's
// two. The solution that continues a hypothesis better costs nothing, however noisy; the other one costs a jump, unless
// the sides are so close to each other that either may be meant.
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace heartservo::tracking {

struct SideFilterOptions {
  double motion_sigma = 0.02;  ///< rad; how far the rotation moves from frame to frame
  double jump = 1e-4;          ///< probability of changing sides
  double memory_s = 0.25;      ///< after a gap this long all is open again: a heart that beats is anywhere by then
  double most_odds = 20;       ///< log odds that are not exceeded, so that a wrong belief ends
  double smoothing = 0.7;      ///< share of a hypothesis' old rotation in its new one

  /// Every problem at once, empty when usable.
  std::vector<std::string> validate() const;
};

class SideFilter {
 public:
  using Rotations = std::array<Eigen::Matrix3d, 2>;

  /// Throws ConfigError for options that do not validate.
  explicit SideFilter(const SideFilterOptions& options = {});

  /// Log probabilities of this frame's two solutions (R_camera_target), up to a common constant, from their `chi2` and
  /// the frames kept. Infinite chi2: no solution. `rotation_sigma`: standard deviation of a solution's rotation, rad.
  std::array<double, 2> log_probabilities(double time_s, const Rotations& rotations, const std::array<double, 2>& chi2,
                                          double rotation_sigma) const;

  /// The same, and the frame counts from now on. A clock that goes back begins anew.
  std::array<double, 2> keep(double time_s, const Rotations& rotations, const std::array<double, 2>& chi2,
                             double rotation_sigma);

 private:
  struct Hypothesis {
    double log_probability;
    Eigen::Quaterniond rotation;
  };
  struct Memory {
    double time_s;
    std::array<Hypothesis, 2> sides;
  };

  void continue_from(const Memory& before, double rotation_sigma, Memory& now) const;
  Memory next(double time_s, const Rotations& rotations, const std::array<double, 2>& chi2,
              double rotation_sigma) const;

  SideFilterOptions options_;
  std::optional<Memory> memory_;
};

}  // namespace heartservo::tracking
