#pragma once
#include <Eigen/Core>

namespace heartservo::servo {

struct MotionSample {
  double time_s = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    ///< m, camera frame
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< m^2
};

struct Prediction {
  bool valid = false;                                    ///< false until the predictor has seen enough
  double time_s = 0;                                     ///< for which the prediction holds
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    ///< m
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();    ///< m/s
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< m^2, of the position
};

/// Foresees the target's position. Samples may be irregular or missing (occlusions are coasted).
class MotionPredictor {
 public:
  virtual ~MotionPredictor() = default;

  /// Samples that are not finite, or not later than the last one, are ignored.
  virtual void observe(const MotionSample& sample) = 0;

  /// A heartbeat: the time (s, the samples' clock) of its R peak. Called when the beat has become known, which is after
  /// it happened: `r_peak_s` may be older than samples already observed, never later than the time of the call. Beats
  /// come in the order in which they happened; one may be missing, or be none. Those that are not finite, or not later
  /// than the last one, are ignored. Predictors that know nothing of hearts ignore all.
  virtual void observe_beat(double r_peak_s) { (void)r_peak_s; }

  /// `time_s` may be any time after the last sample.
  virtual Prediction predict(double time_s) const = 0;
};

}  // namespace heartservo::servo
