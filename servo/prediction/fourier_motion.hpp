#pragma once
// Motion as Fourier series in two phases, that of breathing and that of the heartbeat, with the sidebands by which
// breathing modulates the beat:
//
//   p(phi, theta) = c + sum_k  B_k e^{i k theta}  +  sum_n  A_n e^{i n phi}  +  sum_n  M_n± e^{i (n phi ± theta)}
//
// (Ginhoux et al., "Active filtering of physiological motion in robotized surgery using predictive control", IEEE
// Trans. Robotics 21, 2005: harmonics of both rates, coupled). The phases come from elsewhere; the coefficients are
// found by recursive least squares with slow forgetting. All axes share the phases, hence the regressors, hence one
// information matrix.
#include <Eigen/Core>

namespace heartservo::servo {

struct FourierOptions {
  int respiration_harmonics = 2;
  int cardiac_harmonics = 12;
  int sidebands = 12;    ///< cardiac harmonics that breathing modulates; not more than there are
  double memory_s = 40;  ///< time constant of forgetting
  double respiration_m = 4e-3, cardiac_m = 3e-3, sideband_m = 3e-4;  ///< expected size; of the n-th harmonic, 1/n^2
};

class FourierMotion {
 public:
  using Basis = Eigen::VectorXd;
  using Axes = Eigen::Matrix<double, 1, 3>;

  explicit FourierMotion(const FourierOptions& options);

  /// Forgets all; the mean is about `offset`. `cardiac_harmonics`: as many as are used from now on, not more than the
  /// options have (what lies above the sampling's reach is no motion). `noise_m`: of a measurement, against which the
  /// options' expected sizes are weighed. Allocates nothing.
  void start(const Axes& offset, double noise_m, int cardiac_harmonics);
  /// From now on only so many cardiac harmonics, with sidebands (all) or without, differ from 0: what is known of a few
  /// beats does not hold more. start() opens all.
  void open(int cardiac_harmonics, bool sidebands);

  /// Regressors at a phase of the heart and of breathing (cycles). `h` keeps its size: that of make_basis().
  void basis(double heart, double breath, Basis& h) const;
  Basis make_basis() const { return Basis::Zero(columns_max_); }

  Axes value(const Basis& h) const;
  /// Derivatives of the value by the two phases, m per cycle.
  void slopes(const Basis& h, Axes& by_heart, Axes& by_breath) const;
  /// Variance of the value because of the coefficients, in units of the measurement's variance.
  double variance(const Basis& h);

  /// One measurement with `innovation` = measured - value(h) and a weight of 0 to 1, `dt` after the one before.
  void update(const Basis& h, const Axes& innovation, double weight, double dt);

  int cardiac_harmonics() const { return cardiac_; }

 private:
  FourierOptions options_;
  double noise_m_ = 3e-5;
  int cardiac_ = 0, sidebands_ = 0, columns_ = 0, columns_max_ = 0;
  Eigen::VectorXi n_, m_;                       // per pair of columns: multiples of the heart's and breath's phase
  Eigen::Matrix<double, Eigen::Dynamic, 3> a_;  // coefficients, a column an axis
  Eigen::MatrixXd P_;                           // their covariance, in units of the measurement's variance
  Eigen::VectorXd Ph_;
};

}  // namespace heartservo::servo
