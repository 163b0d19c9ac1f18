#include "sim/heart/ecg_signal.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>

namespace heartservo::sim {

namespace {

struct Wave {
  double mv, at_s, sigma_s;  // at_s: from the R peak
};

double sum_of(std::span<const Wave> waves, double t) {
  double sum = 0;
  for (const Wave& w : waves) {
    const double x = (t - w.at_s) / w.sigma_s;
    if (std::abs(x) < 8) sum += w.mv * std::exp(-0.5 * x * x);
  }
  return sum;
}

constexpr Wave kNormal[] = {{0.12, -0.18, 0.022}, {-0.12, -0.028, 0.009}, {1.0, 0, 0.010}, {-0.22, 0.030, 0.010}};
constexpr Wave kEctopic[] = {{1.15, 0, 0.028}, {-0.35, 0.075, 0.025}};
// The T wave comes later in a slow heart (Bazett: with the square root of the interval).
constexpr double kT_s = 0.28, kTSigma_s = 0.045, kT_mv = 0.3, kTEctopic_mv = -0.45;

double beat_mv(double since, double interval, bool early) {
  const double stretch = std::sqrt(std::clamp(interval, 0.3, 2.0));
  const Wave t{early ? kTEctopic_mv : kT_mv, kT_s * stretch + (early ? 0.05 : 0), kTSigma_s};
  return (early ? sum_of(kEctopic, since) : sum_of(kNormal, since)) + sum_of({&t, 1}, since);
}

class SimulatedEcg final : public servo::EcgSource {
 public:
  SimulatedEcg(const EcgOptions& options, std::vector<double> beats, std::uint64_t seed)
      : options_(options), beats_(std::move(beats)), random_(seed) {}

  double rate_hz() const override { return options_.rate_hz; }

  bool next(double until_s, servo::EcgSample& sample) override {
    const double t = static_cast<double>(count_) / options_.rate_hz - options_.lead_in_s;
    if (t > until_s) return false;
    ++count_;
    const double turn = 2 * std::numbers::pi * t;
    const double wander = options_.wander_mv * (0.7 * std::sin(0.31 * turn + 0.4) + 0.3 * std::sin(0.047 * turn + 2));
    sample = {t, ecg_mv(beats_, t) + wander + options_.hum_mv * std::sin(50 * turn + 1) +
                     options_.noise_mv * normal_(random_)};
    return true;
  }

 private:
  EcgOptions options_;
  std::vector<double> beats_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::size_t count_ = 0;
};

class RecordedEcg final : public servo::EcgSource {
 public:
  RecordedEcg(const EcgOptions& options, servo::EcgRecord record)
      : record_(std::move(record)), start_s_(options.start_s) {
    while (at_ < record_.value.size() && record_.time_s(at_) < start_s_ - options.lead_in_s) ++at_;
  }

  double rate_hz() const override { return record_.rate_hz; }

  bool next(double until_s, servo::EcgSample& sample) override {
    if (at_ == record_.value.size() || record_.time_s(at_) - start_s_ > until_s) return false;
    sample = {record_.time_s(at_) - start_s_, record_.value[at_]};
    ++at_;
    return true;
  }

 private:
  servo::EcgRecord record_;
  double start_s_;
  std::size_t at_ = 0;
};

}  // namespace

double ecg_mv(const std::vector<double>& r, double t) {
  const double mean = r.size() > 1 ? (r.back() - r.front()) / static_cast<double>(r.size() - 1) : 0.8;
  // beat k, with imagined ones before the first and after the last
  const auto beat = [&](long k) {
    const long last = static_cast<long>(r.size()) - 1;
    if (r.empty()) return mean * static_cast<double>(k);
    if (k < 0) return r.front() + mean * static_cast<double>(k);
    return k <= last ? r[static_cast<std::size_t>(k)] : r.back() + mean * static_cast<double>(k - last);
  };
  long next = std::upper_bound(r.begin(), r.end(), t) - r.begin();
  if (next == 0 && !r.empty()) next = static_cast<long>(std::ceil((t - r.front()) / mean));
  if (!r.empty() && t > r.back()) next += static_cast<long>((t - r.back()) / mean);
  double sum = 0;
  for (long k = next - 3; k <= next + 1; ++k) {
    const double before = beat(k) - beat(k - 1);
    sum += beat_mv(t - beat(k), before, before < 0.8 * (beat(k - 1) - beat(k - 2)));
  }
  return sum;
}

std::unique_ptr<servo::EcgSource> make_simulated_ecg(const EcgOptions& options, std::vector<double> r_peaks_s,
                                                     std::uint64_t seed) {
  return std::make_unique<SimulatedEcg>(options, std::move(r_peaks_s), seed);
}

std::unique_ptr<servo::EcgSource> make_recorded_ecg(const EcgOptions& options, servo::EcgRecord record) {
  return std::make_unique<RecordedEcg>(options, std::move(record));
}

}  // namespace heartservo::sim
