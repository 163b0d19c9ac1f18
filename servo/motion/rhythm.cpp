#include "servo/motion/rhythm.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "servo/motion/zero_phase.hpp"

namespace heartservo::servo {

namespace {

// A family must have this share of the power of one axis at least.
constexpr double kLeastShare = 0.02;
// Half the frequency, or the third, explains all the lines that the right one does, and a little more by chance: the
// highest frequency that explains nearly as much as the best is the right one.
constexpr double kNearlyAll = 0.85;
constexpr int kComb = 6;
constexpr double kHighestLine_hz = 10;

// Shares of each axis' power, added up: an axis counts as much as another, however far it moves.
class Shares {
 public:
  explicit Shares(const std::array<Spectrum, 3>& spectra) : spectra_(spectra) {
    for (std::size_t a = 0; a < 3; ++a) total_[a] = spectra[a].power(0, INFINITY);
  }
  double sum(double low, double high) const {
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a)
      if (total_[a] > 0) sum += spectra_[a].power(low, high) / total_[a];
    return sum;
  }
  double density(std::size_t i) const {
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a)
      if (total_[a] > 0) sum += spectra_[a].density[i] / total_[a];
    return sum;
  }
  double largest(double low, double high) const {
    double largest = 0;
    for (std::size_t a = 0; a < 3; ++a)
      if (total_[a] > 0) largest = std::max(largest, spectra_[a].power(low, high) / total_[a]);
    return largest;
  }

 private:
  const std::array<Spectrum, 3>& spectra_;
  std::array<double, 3> total_{};
};

std::vector<double> grid(double from, double to, double step) {
  std::vector<double> values;
  for (double f = from; f <= to; f += step) values.push_back(f);
  return values;
}

// The highest frequency whose score is a local maximum and at least `share` of the best one.
double highest_good(const std::vector<double>& frequencies, const std::function<double(double)>& score, double share) {
  std::vector<double> scores;
  for (const double f : frequencies) scores.push_back(score(f));
  if (scores.size() < 3) return 0;
  const double best = *std::max_element(scores.begin(), scores.end());
  for (std::size_t i = scores.size() - 1; i-- > 1;)
    if (scores[i] >= share * best && scores[i] >= scores[i - 1] && scores[i] > scores[i + 1]) return frequencies[i];
  return 0;
}

// The motion less the sines of breathing that lie below the heart's line: their skirts would pull at it.
UniformMotion without_breath(UniformMotion motion, const Rhythm& rhythm, double blur) {
  const auto n = static_cast<Eigen::Index>(motion.size());
  int harmonics = 0;
  while (rhythm.respiration_hz > 0 && (harmonics + 1) * rhythm.respiration_hz < rhythm.heart_hz - blur && harmonics < 3)
    ++harmonics;
  Eigen::MatrixXd sines(n, 2 * harmonics + 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double turn = 2 * std::numbers::pi * rhythm.respiration_hz * static_cast<double>(i) / motion.rate_hz;
    sines(i, 0) = 1;
    for (int k = 1; k <= harmonics; ++k) sines(i, 2 * k - 1) = std::cos(k * turn), sines(i, 2 * k) = std::sin(k * turn);
  }
  const auto solver = (sines.transpose() * sines).ldlt();
  for (auto& axis : motion.axis) {
    Eigen::Map<Eigen::VectorXd> series(axis.data(), n);
    const Eigen::VectorXd weights = solver.solve(sines.transpose() * series);
    series -= sines * weights;
  }
  return motion;
}

}  // namespace

double mean_frequency(const UniformMotion& motion, double f, int harmonics, double half_width) {
  // towards its ends the record is faded out over two periods: beyond them nothing is known
  const double n = static_cast<double>(motion.size()), ramp = std::min(2 * motion.rate_hz / f, 0.25 * n);
  std::array<std::vector<double>, 3> faded = motion.axis;
  for (auto& axis : faded) {
    double mean = 0;
    for (const double v : axis) mean += v / n;
    for (std::size_t i = 0; i < axis.size(); ++i) {
      const double from_end = std::min(static_cast<double>(i), n - 1 - static_cast<double>(i)) / ramp;
      axis[i] = (axis[i] - mean) * (from_end < 1 ? std::pow(std::sin(0.5 * std::numbers::pi * from_end), 2) : 1);
    }
  }
  double sum = 0, weight = 0;
  for (int k = 1; k <= harmonics; ++k)
    for (const auto& axis : faded) {
      const double low = (k - half_width) * f, high = (k + half_width) * f;
      if (high > 0.45 * motion.rate_hz) continue;
      const AnalyticBand band = analytic_band(axis, motion.rate_hz, low, high);
      std::complex<double> turn = 0;
      for (std::size_t i = 0; i + 1 < band.real.size(); ++i)
        turn += std::complex(band.real[i + 1], band.imaginary[i + 1]) * std::complex(band.real[i], -band.imaginary[i]);
      const double found = std::arg(turn) * motion.rate_hz / (2 * std::numbers::pi);
      const double power = std::abs(turn);
      if (!(found > low && found < high)) continue;
      sum += power * found / k;
      weight += power;
    }
  return weight > 0 ? sum / weight : f;
}

Rhythm find_rhythm(const UniformMotion& motion, const std::array<Spectrum, 3>& spectra) {
  const Shares shares(spectra);
  const double blur = 1 / spectra[0].segment_s, step = spectra[0].step_hz;
  const auto tooth = [&](double f, int k) {
    const double half = blur + 0.01 * k * f;
    return std::pair(k * f - half, k * f + half);
  };
  const auto comb = [&](double f) {
    double sum = 0;
    for (int k = 1; k <= kComb && k * f < std::min(kHighestLine_hz, 0.45 * motion.rate_hz); ++k) {
      const auto [low, high] = tooth(f, k);
      sum += shares.sum(low, high);
    }
    return sum;
  };
  Rhythm rhythm;
  rhythm.heart_hz = highest_good(grid(kLowestHeart_hz, kHighestHeart_hz, step), comb, kNearlyAll);
  const auto breath = [&](double f) {
    const auto [low, high] = tooth(f, 1);
    const auto [low2, high2] = tooth(f, 2);
    return shares.sum(low, high) + 0.5 * shares.sum(low2, high2);
  };
  const auto significant = [&](double f, int harmonics) {
    for (int k = 1; k <= harmonics && f > 0; ++k)
      if (shares.largest(k * f - blur, k * f + blur) > kLeastShare) return true;
    return false;
  };
  // breathing is even enough for its line to have a peak
  const auto peak_near = [&](double f) {
    const auto i = static_cast<std::size_t>(std::lround(f / step));
    std::size_t top = i;
    for (std::size_t k = i > 3 ? i - 3 : 1; k <= i + 3; ++k)
      if (shares.density(k) > shares.density(top)) top = k;
    const double y0 = std::log(shares.density(top - 1)), y1 = std::log(shares.density(top)),
                 y2 = std::log(shares.density(top + 1));
    return step * (static_cast<double>(top) + 0.5 * (y0 - y2) / (y0 - 2 * y1 + y2));
  };
  const double slowest = std::max(kLowestRespiration_hz, 1.5 / motion.duration_s());
  const double fastest =
      rhythm.heart_hz > 0 ? std::min(kHighestRespiration_hz, 0.75 * rhythm.heart_hz) : kHighestRespiration_hz;
  rhythm.respiration_hz = highest_good(grid(slowest - step, fastest, step), breath, 1);
  if (significant(rhythm.respiration_hz, 1))
    rhythm.respiration_hz = peak_near(rhythm.respiration_hz);
  else
    rhythm.respiration_hz = 0;
  if (!significant(rhythm.heart_hz, kComb)) rhythm.heart_hz = 0;
  const UniformMotion beats = without_breath(motion, rhythm, blur);
  for (int pass = 0; pass < 3 && rhythm.heart_hz > 0; ++pass)
    rhythm.heart_hz = mean_frequency(beats, rhythm.heart_hz, 4, 0.3);
  return rhythm;
}

}  // namespace heartservo::servo
