#pragma once
// An ECG made of Gaussian waves, with noise and wander; independent of the simulator's.
#include <cmath>
#include <random>
#include <vector>

namespace heartservo::test {

struct MadeEcg {
  double rate_hz = 360, noise_mv = 0.03, wander_mv = 0.2, gain = 1;
  std::vector<double> beats;      ///< s
  std::vector<std::size_t> wide;  ///< those that are wide and without P wave

  /// `duration_s` of beats about every `period_s`, uneven by `variability`.
  static MadeEcg even(double duration_s, double period_s, double variability, std::uint64_t seed) {
    MadeEcg ecg;
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    for (double t = 0.4; t < duration_s; t += period_s * (1 + variability * normal(random))) ecg.beats.push_back(t);
    return ecg;
  }

  std::vector<double> samples(double duration_s, std::uint64_t seed) const {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<double> values(static_cast<std::size_t>(duration_s * rate_hz));
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double t = static_cast<double>(i) / rate_hz;
      values[i] = wander_mv * std::sin(1.3 * t) + noise_mv * normal(random);
    }
    for (std::size_t k = 0; k < beats.size(); ++k) {
      const bool is_wide = std::find(wide.begin(), wide.end(), k) != wide.end();
      if (!is_wide) add(values, beats[k] - 0.17, 0.1, 0.025);
      add(values, beats[k], 1, is_wide ? 0.026 : 0.011);
      add(values, beats[k] + 0.03 + (is_wide ? 0.05 : 0), -0.2, is_wide ? 0.024 : 0.012);
      add(values, beats[k] + 0.27, is_wide ? -0.3 : 0.35, 0.05);
    }
    for (double& v : values) v *= gain;
    return values;
  }

 private:
  void add(std::vector<double>& values, double at_s, double mv, double sigma_s) const {
    for (double t = at_s - 6 * sigma_s; t < at_s + 6 * sigma_s; t += 1 / rate_hz) {
      const long i = std::lround(t * rate_hz);
      if (i < 0 || i >= static_cast<long>(values.size())) continue;
      const double x = (static_cast<double>(i) / rate_hz - at_s) / sigma_s;
      values[static_cast<std::size_t>(i)] += mv * std::exp(-0.5 * x * x);
    }
  }
};

}  // namespace heartservo::test
