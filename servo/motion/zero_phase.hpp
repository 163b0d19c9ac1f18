#pragma once
// Low-pass without delay: a Butterworth filter run forwards and backwards, and the derivatives of what it lets pass.
#include <span>
#include <vector>

namespace heartservo::servo {

struct ZeroPhaseLowPass {
  double cutoff_hz = 1;  ///< the gain there is 1/2
  int order = 10;        ///< of the Butterworth filter that runs twice

  /// 1 / (1 + (f / cutoff)^(2 order)): the square of a Butterworth filter's amplitude, phase 0.
  double gain(double frequency_hz) const;
};

/// The series (evenly spaced, `rate_hz`) filtered, and its `derivative`th derivative by time (0, 1 or 2). The filter is
/// applied in the frequency domain, where derivatives are exact; the series goes on beyond its ends by odd reflection,
/// so that near the ends (about one period of the cut-off) derivatives are not to be trusted. Two samples or more.
std::vector<double> low_pass(std::span<const double> series, double rate_hz, const ZeroPhaseLowPass& filter,
                             int derivative = 0);

/// What stays of the series between two frequencies (as a product of two such filters), and the same turned by 90
/// degrees: the analytic signal's real and imaginary part.
struct AnalyticBand {
  std::vector<double> real, imaginary;
};
AnalyticBand analytic_band(std::span<const double> series, double rate_hz, double low_hz, double high_hz);

}  // namespace heartservo::servo
