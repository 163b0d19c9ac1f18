#pragma once
// R peaks of an ECG as it comes in, sample by sample: causal, with a delay that is known.
//
// The samples are correlated with the second derivative of a Gaussian (sigma 13 ms, a band around 17 Hz), which fits a
// QRS complex and leaves little of P and T waves, wander of the baseline and mains hum. The kernel is symmetric: a
// local extremum of the response lies at the R peak itself, and is known half a kernel later. The largest extremum
// within 70 ms is a beat when it reaches a threshold between the sizes of recent beats and of what lies between them
// (after Pan and Tompkins, 1985). A pause of 1.66 mean intervals makes the detector look back for a weaker beat.
#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

namespace heartservo::servo {

struct RPeak {
  double time_s = 0;         ///< of the peak, between samples
  double known_s = 0;        ///< when the detector said so: the time of the sample that told
  double size = 0;           ///< of the response, in the signal's unit
  bool looked_back = false;  ///< found late: at the start, or in a pause
};

class RPeakDetector {
 public:
  /// Throws ConfigError for a rate below 50 Hz.
  explicit RPeakDetector(double rate_hz);

  /// The next sample (any unit; NaN: none, the last value is held), at `time_s`. A peak that has become known, the
  /// oldest first; peaks come in the order of their times. Allocates nothing once started.
  std::optional<RPeak> next(double time_s, double value);

  /// From an R peak to its report, unless it was looked back for.
  double delay_s() const;

 private:
  struct Extremum {
    double index = 0;  // of the sample, with a fraction
    double size = 0;   // with the sign of the response
  };

  double respond() const;
  void look_at(const Extremum& extremum);
  void decide(const Extremum& found);
  void accept(const Extremum& extremum, bool looked_back);
  void learn();
  void look_back();
  double beat_size() const;
  double threshold() const;
  double mean_interval() const;
  double seconds(double samples) const { return samples / rate_hz_; }

  double rate_hz_;
  std::vector<double> kernel_;
  std::size_t half_;
  std::vector<double> samples_;  // ring as long as the kernel
  std::size_t count_ = 0;        // of samples so far
  double last_value_ = 0, time_s_ = 0;
  std::array<double, 3> response_{};  // the last three, for local extrema
  std::optional<Extremum> pending_;   // largest extremum of the last 70 ms
  std::vector<Extremum> since_beat_;  // candidates since the last beat that were too small, of bounded number
  std::array<double, 8> sizes_{}, intervals_{};
  std::size_t beats_ = 0;      // accepted since learning
  double noise_ = 0;           // mean size of what was too small
  double sign_ = 0;            // mean sign of beats, -1 to 1
  double last_beat_ = -1e9;    // sample
  double learning_until_ = 0;  // sample; > count_ while learning
  std::deque<RPeak> known_;
};

}  // namespace heartservo::servo
