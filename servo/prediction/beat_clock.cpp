#include "servo/prediction/beat_clock.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::servo {

namespace {

constexpr double kCorrelation = 0.3;   // of successive beats' stretch
constexpr double kRateDrift = 1e-3;    // relative change of f in a second, standard deviation
constexpr double kPhaseJitter = 3e-3;  // cycles in a root second: the model is not the heart

double wrapped(double cycles) { return cycles - std::floor(cycles); }

}  // namespace

void BeatClock::start(const BeatModel& model, double phase, double rate_hz, double rate_sigma, double phase_sigma) {
  model_ = model;
  mean_ = 0;
  sigma_ = 0.06;
  expected_ = 0;
  beats_ = 0;
  x_ = {phase, rate_hz, 0};
  P_ = Eigen::Vector3d(phase_sigma * phase_sigma, std::pow(rate_sigma * rate_hz, 2), sigma_ * sigma_).asDiagonal();
  diastole_ = !in_systole(phase);
}

void BeatClock::restart(const BeatClock& other, double phase, double phase_sigma) {
  *this = other;
  x_[0] = phase;
  x_[2] = mean_;
  P_.row(0).setZero();
  P_.col(0).setZero();
  P_.row(2).setZero();
  P_.col(2).setZero();
  P_(0, 0) = phase_sigma * phase_sigma;
  P_(2, 2) = sigma_ * sigma_;
  diastole_ = !in_systole(phase);
}

double BeatClock::systole_share() const { return std::min(0.75, model_.systole_s * x_[1]); }

bool BeatClock::in_systole(double phase) const { return wrapped(phase - model_.anchor) < systole_share(); }

double BeatClock::mean_rate_hz() const {
  const double s = systole_share();
  return x_[1] / (s + (1 - s) / (1 + mean_));
}

void BeatClock::begin_diastole() {
  diastole_ = true;
  ++turns_;
  expected_ = mean_ + kCorrelation * (x_[2] - mean_);
  // the phase's error turns with the rate: it was an error of the time at which diastole begins
  P_.row(2).setZero();
  P_.col(2).setZero();
  P_(2, 2) = sigma_ * sigma_;
  const double turn = 1 + expected_;
  P_.row(0) *= turn;
  P_.col(0) *= turn;
  x_[2] = expected_;
}

void BeatClock::end_diastole() {
  diastole_ = false;
  ++turns_;
  const double turn = 1 / std::max(0.2, 1 + x_[2]);
  P_.row(0) *= turn;
  P_.col(0) *= turn;
  ++beats_;
  const double gain = std::max(1.0 / 10, 1.0 / (beats_ + 2)), off = x_[2] - expected_;
  sigma_ = std::clamp(std::sqrt((1 - gain) * sigma_ * sigma_ + gain * off * off), 0.004, 0.4);
  mean_ += std::max(1.0 / 20, 1.0 / (beats_ + 2)) * (x_[2] - mean_);
  mean_ = std::clamp(mean_, -0.3, 0.3);
}

void BeatClock::advance(double dt) {
  const auto run = [&](double step) {  // no boundary in between
    const double d = diastole_ ? x_[2] : 0;
    Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
    F(0, 1) = (1 + d) * step;
    if (diastole_) F(0, 2) = x_[1] * step;
    double keep = 1;
    if (model_.systole_s == 0) keep = std::exp(-step / 1.0);
    x_[0] += x_[1] * (1 + d) * step;
    x_[2] = mean_ + keep * (x_[2] - mean_);
    F(2, 2) = keep;
    P_ = (F * P_ * F.transpose()).eval();
    P_(0, 0) += kPhaseJitter * kPhaseJitter * step;
    P_(1, 1) += std::pow(kRateDrift * x_[1], 2) * step;
    if (diastole_) P_(2, 2) += sigma_ * sigma_ * (model_.softness * step + 1 - keep * keep);
  };
  if (model_.systole_s == 0) {
    diastole_ = true;
    run(dt);
    return;
  }
  for (int guard = 0; dt > 0 && guard < 64; ++guard) {
    const double in_beat = wrapped(x_[0] - model_.anchor), s = systole_share();
    const double left =
        diastole_ ? (in_beat < 0.5 * s ? 0 : 1 - in_beat) : s - (in_beat > 0.5 * (1 + s) ? in_beat - 1 : in_beat);
    const double rate = x_[1] * (diastole_ ? 1 + x_[2] : 1);
    const double until = std::max(0.0, left) / rate;
    if (until > dt) {
      run(dt);
      return;
    }
    run(until);
    dt -= until;
    if (diastole_)
      end_diastole();
    else
      begin_diastole();
  }
}

double BeatClock::foresee(double dt, double& variance, double& rate) const {
  BeatClock then = *this;
  then.advance(dt);
  variance = then.P_(0, 0);
  rate = then.x_[1] * (then.diastole_ ? 1 + then.x_[2] : 1);
  return then.x_[0];
}

void BeatClock::update(double innovation, double slope, double variance) {
  const Eigen::Vector3d Ph = P_.col(0) * slope;
  const double s = slope * Ph[0] + variance;
  const Eigen::Vector3d k = Ph / s;
  x_ += k * innovation;
  P_ -= k * Ph.transpose();
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  x_[2] = std::clamp(x_[2], -0.7, 3.0);
}

}  // namespace heartservo::servo
