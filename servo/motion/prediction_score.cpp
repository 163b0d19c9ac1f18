#include "servo/motion/prediction_score.hpp"

#include <algorithm>
#include <cmath>

#include "servo/prediction/noise_estimate.hpp"

namespace heartservo::servo {

namespace {

constexpr double kUnlocked_m = 3e-3, kBeat_s = 0.8;

struct Sums {
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  std::vector<double> distances;
};

HorizonScore result_of(double horizon_s, Sums& sums) {
  HorizonScore score;
  score.horizon_s = horizon_s;
  score.scored = sums.distances.size();
  if (score.scored == 0) {
    score.axis_rms_m.setConstant(NAN);
    score.rms_m = score.p99_m = score.max_m = NAN;
    return score;
  }
  const auto n = static_cast<double>(score.scored);
  score.axis_rms_m = (sums.squares / n).cwiseSqrt();
  score.rms_m = std::sqrt(sums.squares.sum() / n);
  std::sort(sums.distances.begin(), sums.distances.end());
  score.p99_m = sums.distances[(score.scored - 1) * 99 / 100];
  score.max_m = sums.distances.back();
  return score;
}

MotionSample sample_at(const MotionRecord& record, std::size_t row, const NoiseEstimate& noise) {
  MotionSample sample{record.time_s[row], record.measured[row], Eigen::Matrix3d::Zero()};
  if (noise.known()) sample.covariance.diagonal() = noise.variance().transpose();
  return sample;
}

}  // namespace

Eigen::Vector3d position_at(const MotionRecord& record, double time_s) {
  constexpr double kSame_s = 1e-6;
  const auto& known = record.truth.empty() ? record.measured : record.truth;
  const auto above = std::lower_bound(record.time_s.begin(), record.time_s.end(), time_s - kSame_s);
  if (above == record.time_s.end()) return Eigen::Vector3d::Constant(NAN);
  const auto i = static_cast<std::size_t>(above - record.time_s.begin());
  if (*above - time_s <= kSame_s) return known[i];
  if (i == 0 || *above - record.time_s[i - 1] > 0.1) return Eigen::Vector3d::Constant(NAN);
  const double share = (time_s - record.time_s[i - 1]) / (*above - record.time_s[i - 1]);
  return (1 - share) * known[i - 1] + share * known[i];
}

PredictionScore score_predictor(
    const MotionRecord& record, const ScoreOptions& options, MotionPredictor& predictor,
    const std::function<void(std::size_t, std::size_t, const Prediction&, const Eigen::Vector3d&)>& watch) {
  std::vector<Sums> sums(options.horizons_s.size());
  PredictionScore score;
  NoiseEstimate noise;
  std::size_t beat = 0;
  double above_since = INFINITY;
  bool counted = false;
  for (std::size_t row = 0; row < record.time_s.size(); ++row) {
    const double now = record.time_s[row];
    while (beat < options.r_peaks_s.size() && options.r_peaks_s[beat] <= now)
      predictor.observe_beat(options.r_peaks_s[beat++]);
    if (record.measured[row].allFinite()) {
      noise.add(now, record.measured[row].transpose());
      predictor.observe(sample_at(record, row, noise));
    }
    const bool settled = now - record.time_s.front() >= options.settle_s;
    for (std::size_t h = 0; h < sums.size(); ++h) {
      const Prediction p = predictor.predict(now + options.horizons_s[h]);
      const Eigen::Vector3d truth = position_at(record, now + options.horizons_s[h]);
      if (watch) watch(row, h, p, truth);
      if (!settled || !truth.allFinite()) continue;
      // no prediction is none of the loop's choices: the last place known would be all it had
      const Eigen::Vector3d off = p.valid ? Eigen::Vector3d(p.position - truth) : Eigen::Vector3d::Constant(NAN);
      if (!off.allFinite()) continue;
      sums[h].squares += off.cwiseAbs2();
      sums[h].distances.push_back(off.norm());
      if (h > 0) continue;
      if (off.norm() <= kUnlocked_m) {
        above_since = INFINITY;
        counted = false;
      } else {
        above_since = std::min(above_since, now);
        if (!counted && now - above_since >= kBeat_s) {
          ++score.unlocks;
          counted = true;
        }
      }
    }
  }
  for (std::size_t h = 0; h < sums.size(); ++h) score.horizons.push_back(result_of(options.horizons_s[h], sums[h]));
  return score;
}

}  // namespace heartservo::servo
