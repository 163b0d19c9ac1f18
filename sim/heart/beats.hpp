#pragma once
// When the heart beats and the lungs fill, and how a cycle's phase runs between two such marks.
//
// A heart that beats slower does not move slower throughout: systole (contraction) keeps its duration and only
// diastole stretches. A motion written as a function of phase therefore needs a phase that runs at its nominal rate
// for the first 0.35 s after each R peak and makes up the difference afterwards.
#include <cstdint>
#include <vector>

namespace heartservo::sim {

/// Duration of systole in s, whatever the beat's length.
inline constexpr double kSystole_s = 0.35;

/// How the marks of a cycle (R peaks, starts of inspiration) are scattered.
struct CycleStatistics {
  double rate_hz = 1.19;      ///< mean rate
  double variability = 0.02;  ///< standard deviation of a cycle's period, relative to the mean
  double correlation = 0.3;   ///< of successive periods (first-order autoregression)
};

/// Times (s, increasing) of marks that cover [0, duration_s]: the first lies up to one period before 0 (a random start
/// phase), the last after duration_s. Periods stay within 4 standard deviations and above half the mean.
std::vector<double> cycle_marks(const CycleStatistics& statistics, double duration_s, std::uint64_t seed);

/// Makes beats come early: each with probability `share`, never two in a row nor the first and last two, by `advance`
/// of the interval before it; the next one comes when it would have come anyway (a compensatory pause, as after a
/// ventricular ectopic beat).
std::vector<double> with_ectopic_beats(std::vector<double> marks_s, double share, double advance, std::uint64_t seed);

/// R peaks read from an ECG (s, any order): sorted, without peaks that follow another by less than
/// systole plus 0.1 s, which this heart could not beat.
std::vector<double> plausible_beats(std::vector<double> r_peaks_s);

/// Time -> phase. Each cycle runs at the nominal rate for `fixed_s` after its mark, then faster or slower so as to be
/// complete at the next mark. A cycle of nominal length is the identity t / period. Three times continuously
/// differentiable and strictly increasing for every length above fixed_s, however long; before the first and after the
/// last mark cycles have the nominal length.
class PhaseClock {
 public:
  /// Throws ConfigError unless the marks increase by more than `fixed_s` and fixed_s < nominal_period_s.
  PhaseClock(std::vector<double> marks_s, double nominal_period_s, double fixed_s);

  /// In [0, 1); 0 at each mark.
  double phase(double t) const;

  const std::vector<double>& marks() const { return marks_; }

 private:
  std::vector<double> marks_;
  double nominal_s_;
  double fixed_s_;
};

}  // namespace heartservo::sim
