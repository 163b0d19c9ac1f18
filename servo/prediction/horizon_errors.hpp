#pragma once
// How well several predictors foresaw what then came, at one horizon, and what mixture of them would have done best.
//
// Each prediction is kept until a sample reaches the time it was for; the errors then enter running means of their
// products, E[e_i . e_j]. The weights that add up to 1 and leave least are C^-1 1 / (1' C^-1 1) (Bates and Granger,
// "The combination of forecasts", 1969), here without negative ones. The samples' own noise adds the same to every
// product and does not move the weights. What lies between two samples is taken from the straight line between them.
// Nothing is allocated after construction.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

namespace heartservo::servo {

class HorizonErrors {
 public:
  using Axes = Eigen::Matrix<double, 1, 3>;
  static constexpr int kMostPredictors = 8;
  using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMostPredictors, 3>;
  using Weights = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostPredictors, 1>;

  /// Time constants: of the means, and of a faster one of each predictor's own error, which tells that it has failed.
  HorizonErrors(double horizon_s, int predictors, double slow_s = 6, double fast_s = 0.5);

  double horizon_s() const { return horizon_s_; }
  void forget();

  /// A sample has come: what was foreseen for the time since the one before is judged.
  void observe(double time_s, const Axes& position);
  /// Room for the predictions made at `time_s`, for the horizon later; a row a predictor, NaN for none.
  Positions& predictions(double time_s);

  /// Mean squared distances, m^2; infinite before anything came true.
  double fast(int i) const { return age_[i] > kLeast_s ? fast_[i] : INFINITY; }
  double slow(int i) const { return age_[i] > kLeast_s ? products_(i, i) : INFINITY; }
  /// The largest distance of late, m; forgotten with a time constant of 20 s. 0 before anything came true.
  double largest(int i) const { return largest_[i]; }
  double experience_s(int i) const { return age_[i]; }

  /// Of each predictor; all 0 when nothing is known of any.
  const Weights& weights() const { return weights_; }
  void weigh();

 private:
  static constexpr std::size_t kMost = 256;
  static constexpr double kGap_s = 0.1, kLargest_s = 20, kLeast_s = 0.4;
  struct Pending {
    double time_s = 0, dt = 0;
    Positions positions;
  };

  void judge(const Positions& errors, double dt);

  double horizon_s_, slow_s_, fast_s_;
  std::vector<Pending> pending_;
  std::size_t first_ = 0, end_ = 0;
  double last_s_ = 0, added_s_ = 0;
  Axes last_ = Axes::Zero();
  bool seen_ = false;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostPredictors, kMostPredictors> products_;
  Weights fast_, age_, largest_, weights_;
};

}  // namespace heartservo::servo
