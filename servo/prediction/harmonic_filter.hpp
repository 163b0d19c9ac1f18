#pragma once
// Dual estimation of a quasi-periodic motion: a bank of beat clocks, a breath clock, and the Fourier coefficients.
#include <array>
#include <vector>

#include "servo/prediction/beat_clock.hpp"
#include "servo/prediction/breath_clock.hpp"
#include "servo/prediction/fourier_motion.hpp"

namespace heartservo::servo {

struct HarmonicEstimate {
  FourierMotion::Axes position = FourierMotion::Axes::Zero(), velocity = FourierMotion::Axes::Zero();
  FourierMotion::Axes variance = FourierMotion::Axes::Zero();
};

class HarmonicFilter {
 public:
  using Axes = FourierMotion::Axes;
  explicit HarmonicFilter(const FourierOptions& fourier);

  /// Forgets all. Then teach() with phases that are known, then track().
  void start(const Axes& position, double noise_m, double beat_hz, double period_s);
  /// One measurement at known phases: the coefficients alone are found.
  void teach(double time_s, const Axes& position, double heart, double breath);
  /// From now on the phases are found as well.
  void track(double time_s, double heart, double beat_hz, double breath, double breath_hz);
  /// `noise`: variance of the measurement per axis.
  void observe(double time_s, const Axes& position, const Axes& noise);
  /// An R peak at a time not later than the last measurement: systole began then.
  void observe_beat(double r_peak_s, double sigma_s);
  HarmonicEstimate predict(double time_s);

  double time_s() const { return time_s_; }
  const BeatClock& clock() const { return clocks_[best_]; }
  const BreathClock& breath() const { return breath_; }
  const Axes& innovation() const { return innovation_; }
  std::size_t best() const { return best_; }
  Axes residual_variance() const { return residual_; }

 private:
  void focus(double spacing);
  void add_knot(double phase);
  void learn();
  double phase_at(double time_s) const;
  struct Seen {
    double time_s, breath;
    Axes position;
  };
  static constexpr std::size_t kSeen = 1024;
  static constexpr std::size_t kAnchors = 16, kClocks = kAnchors;

  FourierMotion motion_;
  std::array<BeatClock, kClocks> clocks_;
  std::array<double, kClocks> score_{};
  BreathClock breath_;
  std::size_t best_ = 0;
  FourierMotion::Basis h_;
  Axes innovation_ = Axes::Zero(), residual_ = Axes::Zero();
  double time_s_ = 0, started_s_ = 0, focused_s_ = 0, spacing_ = 1;
  long taught_ = 0;
  std::array<Seen, kSeen> seen_;
  std::size_t seen_end_ = 0, learnt_ = 0, learnable_ = 0;  // counts of samples
  struct Knot {
    double time_s = 0, phase = 0;
  };
  Knot from_, to_, last_;
  int turns_ = 0, peaks_ = 0;
};

}  // namespace heartservo::servo
