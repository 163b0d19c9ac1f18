#pragma once
// The phase of a heartbeat of which only diastole stretches, tracked by an extended Kalman filter.
//
// The phase phi (cycles) runs at the rate f during systole, which lasts 0.35 s after the R peak at phi = anchor, and at
// f (1 + d) in diastole, where d belongs to the beat: it is drawn anew, N(mean, sigma^2), when diastole begins. States
// (phi, f, d); measured is the motion through its slope by phi. Spread and mean of d are learned from the beats seen.
#include <Eigen/Core>

namespace heartservo::servo {

struct BeatModel {
  double anchor = 0;        ///< phase at which systole begins, cycles
  double systole_s = 0.35;  ///< 0: the whole beat stretches, and d is a stationary process in time
  double softness = 0;      ///< in diastole the variance of d grows by this share of sigma^2 a second
};

class BeatClock {
 public:
  /// Prior knowledge: `rate_hz` within `rate_sigma` (relative).
  void start(const BeatModel& model, double phase, double rate_hz, double rate_sigma, double phase_sigma);

  /// As `other`, but at another phase; the beat is a new one.
  void restart(const BeatClock& other, double phase, double phase_sigma);

  /// Lets `dt` seconds go by.
  void advance(double dt);
  /// The phase `dt` from now, not wrapped, and the variance of it; nothing changes. `rate`: cycles per second then.
  double foresee(double dt, double& variance, double& rate) const;
  /// A scalar measurement whose value is too large by `innovation`, with the `slope` by phi and noise `variance`.
  void update(double innovation, double slope, double variance);

  /// The beat turns out to be another one than was expected: its stretch is known `sigma` less well. Not in systole.
  void doubt(double sigma) {
    if (diastole_) P_(2, 2) += sigma * sigma;
  }

  /// How many times systole or diastole began.
  int turns() const { return turns_; }
  double phase() const { return x_[0]; }
  double phase_variance() const { return P_(0, 0); }
  double rate_hz() const { return x_[1]; }
  double stretch() const { return x_[2]; }
  double stretch_sigma() const { return sigma_; }
  double mean_rate_hz() const;
  const BeatModel& model() const { return model_; }
  void set_model(const BeatModel& m) { model_ = m; }
  /// Shifts the phase's origin.
  void shift(double cycles) { x_[0] += cycles; }
  void set_phase(double cycles) { x_[0] = cycles; }

 private:
  bool in_systole(double phase) const;
  double systole_share() const;
  void begin_diastole();
  void end_diastole();

  BeatModel model_;
  Eigen::Vector3d x_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P_ = Eigen::Matrix3d::Zero();
  double mean_ = 0, sigma_ = 0.05, expected_ = 0;
  bool diastole_ = false;
  int beats_ = 0, turns_ = 0;
};

}  // namespace heartservo::servo
