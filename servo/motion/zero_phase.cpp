#include "servo/motion/zero_phase.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <opencv2/core.hpp>

namespace heartservo::servo {

namespace {

using Complex = std::complex<double>;
constexpr double kTau = 2 * std::numbers::pi;

// The series without the line through its ends, gone on by odd reflection about its last value to a length that
// transforms quickly, then followed by its odd reflection about zero: periodic, without a step.
struct Reflected {
  std::vector<Complex> values;
  double first = 0, slope = 0;  // of the line, per sample
};

Reflected reflected(std::span<const double> series) {
  const std::size_t n = series.size(), half = static_cast<std::size_t>(cv::getOptimalDFTSize(static_cast<int>(n - 1)));
  const auto gone_on = [&](std::size_t i) {
    if (i < n) return series[i];
    const std::size_t over = std::min(i - (n - 1), n - 1);
    return 2 * series[n - 1] - series[n - 1 - over];
  };
  Reflected r;
  r.first = series[0];
  r.slope = (gone_on(half) - r.first) / static_cast<double>(half);
  r.values.assign(2 * half, 0);
  for (std::size_t i = 1; i < half; ++i) {
    const double value = gone_on(i) - r.first - r.slope * static_cast<double>(i);
    r.values[i] = value;
    r.values[2 * half - i] = -value;
  }
  return r;
}

void transform(std::vector<Complex>& values, int flags) {
  cv::Mat all(1, static_cast<int>(values.size()), CV_64FC2, values.data());
  cv::dft(all, all, flags);
}

// Multiplies the spectrum by gain(frequency), which may be negative or 0 on the way; frequencies from -rate/2 to
// rate/2.
template <class Gain>
void filter(std::vector<Complex>& values, double rate_hz, const Gain& gain) {
  transform(values, 0);
  const auto n = static_cast<double>(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double index = 2 * k <= values.size() ? static_cast<double>(k) : static_cast<double>(k) - n;
    values[k] *= gain(index * rate_hz / n);
  }
  transform(values, cv::DFT_INVERSE | cv::DFT_SCALE);
}

}  // namespace

double ZeroPhaseLowPass::gain(double frequency_hz) const {
  return 1 / (1 + std::pow(std::abs(frequency_hz) / cutoff_hz, 2 * order));
}

std::vector<double> low_pass(std::span<const double> series, double rate_hz, const ZeroPhaseLowPass& low,
                             int derivative) {
  Reflected r = reflected(series);
  filter(r.values, rate_hz, [&](double f) { return low.gain(f) * std::pow(Complex(0, kTau * f), derivative); });
  std::vector<double> result(series.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double line = derivative == 0   ? r.first + r.slope * static_cast<double>(i)
                        : derivative == 1 ? r.slope * rate_hz
                                          : 0;
    result[i] = (i < r.values.size() ? r.values[i].real() : 0) + line;  // a series of two has nothing but its line
  }
  return result;
}

AnalyticBand analytic_band(std::span<const double> series, double rate_hz, double low_hz, double high_hz) {
  Reflected r = reflected(series);
  const ZeroPhaseLowPass up{high_hz, 10}, down{low_hz, 10};
  filter(r.values, rate_hz,
         [&](double f) { return f > 0 ? Complex(2 * up.gain(f) * (1 - down.gain(f))) : Complex(0); });
  AnalyticBand band;
  for (std::size_t i = 0; i < series.size() && i < r.values.size(); ++i) {
    band.real.push_back(r.values[i].real());
    band.imaginary.push_back(r.values[i].imag());
  }
  return band;
}

}  // namespace heartservo::servo
