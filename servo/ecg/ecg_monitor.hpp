#pragma once
// The ECG as a loop gets it: samples up to now, and no further; and the beats that a detector makes of them.
#include <memory>

#include "servo/ecg/r_peak_detector.hpp"

namespace heartservo::servo {

struct EcgSample {
  double time_s = 0;  ///< on the frames' clock
  double value = 0;   ///< in any unit, mV most often; NaN: no sample
};

/// A simulated, recorded or connected ECG.
class EcgSource {
 public:
  virtual ~EcgSource() = default;
  virtual double rate_hz() const = 0;
  /// The next sample, if its time has come: false where the next one is later than `until_s`, or at the end.
  virtual bool next(double until_s, EcgSample& sample) = 0;
};

class EcgMonitor {
 public:
  explicit EcgMonitor(std::unique_ptr<EcgSource> source) : source_(std::move(source)), detector_(source_->rate_hz()) {}

  /// Takes all samples up to `until_s`; `on_peak(const RPeak&)` is called for each R peak that they make known.
  template <class OnPeak>
  void advance(double until_s, OnPeak&& on_peak) {
    for (EcgSample sample; source_->next(until_s, sample);)
      if (const auto peak = detector_.next(sample.time_s, sample.value)) on_peak(*peak);
  }

  double delay_s() const { return detector_.delay_s(); }

 private:
  std::unique_ptr<EcgSource> source_;
  RPeakDetector detector_;
};

}  // namespace heartservo::servo
