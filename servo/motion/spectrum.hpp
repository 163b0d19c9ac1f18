#pragma once
// Power spectral density by Welch's method: the mean of the spectra of overlapping windowed segments (P. D. Welch,
// 1967).
#include <span>
#include <vector>

namespace heartservo::servo {

struct Spectrum {
  double step_hz = 0;           ///< from one value to the next; the segments are zero-padded, so it is finer than the
                                ///< resolution
  double segment_s = 0;         ///< length of a segment; lines closer than about 2 / segment_s are one
  int segments = 0;             ///< that were averaged
  std::vector<double> density;  ///< one-sided, m^2/Hz, at 0, step_hz, 2 step_hz, ... to half the sampling rate

  double frequency_hz(std::size_t i) const { return step_hz * static_cast<double>(i); }
  /// The integral of the density between two frequencies, m^2; a share of a value's width counts as that share.
  double power(double low_hz, double high_hz) const;
};

/// `segment_s`: of each segment (a Hann window, half overlapping); a longer one than the series takes it whole. Means
/// are taken off segment by segment. Eight samples or more.
Spectrum welch(std::span<const double> series, double rate_hz, double segment_s);

/// The level of white noise below the spectrum: the mean density in its upper `share`, m^2/Hz.
double noise_density(const Spectrum& spectrum, double share = 0.3);

}  // namespace heartservo::servo
