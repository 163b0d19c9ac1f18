#include "servo/motion/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

namespace heartservo::servo {

double Spectrum::power(double low_hz, double high_hz) const {
  double sum = 0;
  for (std::size_t i = 0; i < density.size(); ++i) {
    const double low = std::max(low_hz, frequency_hz(i) - 0.5 * step_hz),
                 high = std::min(high_hz, frequency_hz(i) + 0.5 * step_hz);
    if (high > low) sum += density[i] * (high - low);
  }
  return sum;
}

Spectrum welch(std::span<const double> series, double rate_hz, double segment_s) {
  constexpr int kPadding = 4;
  const std::size_t n =
      std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(segment_s * rate_hz)), 8, series.size());
  const int padded = cv::getOptimalDFTSize(static_cast<int>(kPadding * n));
  std::vector<double> window(n);
  double window_power = 0;
  for (std::size_t i = 0; i < n; ++i) {
    window[i] = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(n));
    window_power += window[i] * window[i];
  }
  Spectrum spectrum;
  spectrum.step_hz = rate_hz / padded;
  spectrum.segment_s = static_cast<double>(n) / rate_hz;
  spectrum.density.assign(static_cast<std::size_t>(padded / 2 + 1), 0);
  // as many half-overlapping segments as fit, spread so that the last one ends with the series
  spectrum.segments = static_cast<int>((series.size() - n) / std::max<std::size_t>(n / 2, 1)) + 1;
  cv::Mat segment(1, padded, CV_64FC1), transformed;
  for (int s = 0; s < spectrum.segments; ++s) {
    const std::size_t from = spectrum.segments == 1 ? 0
                                                    : (series.size() - n) * static_cast<std::size_t>(s) /
                                                          static_cast<std::size_t>(spectrum.segments - 1);
    double mean = 0;
    for (std::size_t i = 0; i < n; ++i) mean += series[from + i] / static_cast<double>(n);
    segment.setTo(0);
    for (std::size_t i = 0; i < n; ++i)
      segment.at<double>(0, static_cast<int>(i)) = window[i] * (series[from + i] - mean);
    cv::dft(segment, transformed, cv::DFT_COMPLEX_OUTPUT);
    const double scale = 2 / (rate_hz * window_power * spectrum.segments);
    for (std::size_t k = 0; k < spectrum.density.size(); ++k) {
      const auto& value = transformed.at<cv::Vec2d>(0, static_cast<int>(k));
      spectrum.density[k] += scale * (value[0] * value[0] + value[1] * value[1]);
    }
  }
  spectrum.density.front() /= 2;
  if (padded % 2 == 0) spectrum.density.back() /= 2;
  return spectrum;
}

double noise_density(const Spectrum& spectrum, double share) {
  const auto from = static_cast<std::size_t>((1 - share) * static_cast<double>(spectrum.density.size()));
  double sum = 0;
  for (std::size_t i = from; i + 1 < spectrum.density.size(); ++i) sum += spectrum.density[i];
  return sum / static_cast<double>(std::max<std::size_t>(spectrum.density.size() - 1 - from, 1));
}

}  // namespace heartservo::servo
