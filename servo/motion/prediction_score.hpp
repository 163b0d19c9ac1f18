#pragma once
// A predictor on a recorded motion, as it would run live: it is given row after row, is asked at each row for the
// positions some horizons later, and its answers are scored against what the record has at those times.
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "servo/motion/motion_record.hpp"
#include "servo/prediction/motion_predictor.hpp"

namespace heartservo::servo {

struct ScoreOptions {
  std::vector<double> horizons_s;  ///< one at least, increasing
  double settle_s = 30;            ///< predictions made earlier, from the record's first row on, do not count
  std::vector<double> r_peaks_s;   ///< heartbeats; each is told at the first row that is not before it
};

struct HorizonScore {
  double horizon_s = 0;
  Eigen::Vector3d axis_rms_m = Eigen::Vector3d::Zero();
  double rms_m = 0, p99_m = 0, max_m = 0;  ///< of the distance
  std::size_t scored = 0;                  ///< predictions; of none all is NaN
};

struct PredictionScore {
  std::vector<HorizonScore> horizons;
  /// How often the distance at the shortest horizon stayed above 3 mm for 0.8 s, about a beat.
  int unlocks = 0;
};

/// Where the record is at `time_s`: the truth if it has one, else the measurement; on the straight line between two
/// rows that are neighbours in time. NaN where it is not known.
Eigen::Vector3d position_at(const MotionRecord& record, double time_s);

/// `watch`, if any, sees every prediction: row, index of the horizon, prediction, and where the record really is then.
/// Measurement noise is not in a record: predictors are given an estimate of it from the rows up to then.
PredictionScore score_predictor(
    const MotionRecord& record, const ScoreOptions& options, MotionPredictor& predictor,
    const std::function<void(std::size_t, std::size_t, const Prediction&, const Eigen::Vector3d&)>& watch = nullptr);

}  // namespace heartservo::servo
