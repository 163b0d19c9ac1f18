#pragma once
// The harmonic model from the first sample on: finds the rates, learns the motion, tracks it, notices when it has lost
// it and begins again. All work is cut so that a sample costs about the same whatever is going on.
#include <array>
#include <vector>

#include "servo/prediction/harmonic_filter.hpp"
#include "servo/prediction/horizon_errors.hpp"
#include "servo/prediction/noise_estimate.hpp"
#include "servo/prediction/rate_search.hpp"
#include "servo/prediction/registry.hpp"

namespace heartservo::servo {

struct HarmonicOptions {
  FourierOptions fourier;
  double smallest_sigma_m = 1e-5;
  bool use_beats = false;  ///< R peaks set the phase
};

HarmonicOptions harmonic_options(const PredictorOptions& options, bool use_beats);

class HarmonicTracker {
 public:
  using Axes = FourierMotion::Axes;

  explicit HarmonicTracker(const HarmonicOptions& options);

  /// `covariance` diagonal per axis, 0 where not known. Time goes on and all is finite: the caller sees to it.
  void observe(double time_s, const Axes& position, const Axes& variance);
  void observe_beat(double r_peak_s);

  /// True while the phases are being tracked up to now.
  bool locked() const { return stage_ == Stage::FOLLOW; }
  /// Only while locked.
  HarmonicEstimate predict(double time_s) { return filter_.predict(time_s); }
  const HarmonicFilter& filter() const { return filter_; }
  /// All is to be found anew, from what was seen lately.
  void search_again();

 private:
  enum class Stage { GATHER, SEARCH, TEACH, CATCH_UP, FOLLOW };
  struct Sample {
    double time_s;
    Axes position, noise;
  };
  static constexpr std::size_t kSamples = 2048;
  static constexpr double kMemory_s = 8;

  const Sample& sample(std::size_t i) const { return samples_[i % kSamples]; }
  Axes noise_of(const Axes& variance) const;
  void slice();
  void gather();
  void teach();
  void catch_up();
  std::size_t first_after(double time_s) const;
  void use_beats();

  HarmonicOptions options_;
  UniformTrack track_;
  NoiseEstimate noise_;
  RateSearch search_;
  HarmonicFilter filter_;
  Stage stage_ = Stage::GATHER;
  std::vector<Sample> samples_;
  std::size_t begin_ = 0, end_ = 0,
              next_ = 0;  // counts of samples: the oldest kept, the newest, the next to be replayed
  double period_s_ = 0, last_s_ = 0, wait_until_s_ = 0;
  bool restarted_ = false;
  long count_ = 0;
  std::array<double, 16> beats_{};
  std::size_t beat_count_ = 0, beats_used_ = 0;
};

}  // namespace heartservo::servo
