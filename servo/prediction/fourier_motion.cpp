#include "servo/prediction/fourier_motion.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace heartservo::servo {

namespace {

constexpr double kTau = 2 * std::numbers::pi;

std::complex<double> turn(double cycles) { return std::polar(1.0, kTau * cycles); }

}  // namespace

FourierMotion::FourierMotion(const FourierOptions& options) : options_(options) {
  const int pairs = options.respiration_harmonics + options.cardiac_harmonics +
                    2 * std::min(options.sidebands, options.cardiac_harmonics);
  columns_max_ = 1 + 2 * pairs;
  n_.resize(pairs);
  m_.resize(pairs);
  a_.setZero(columns_max_, 3);
  P_.setZero(columns_max_, columns_max_);
  Ph_.setZero(columns_max_);
}

void FourierMotion::start(const Axes& offset, double noise_m, int cardiac_harmonics) {
  noise_m_ = noise_m;
  cardiac_ = std::clamp(cardiac_harmonics, 1, options_.cardiac_harmonics);
  sidebands_ = std::min(options_.sidebands, cardiac_);
  a_.setZero();
  a_.row(0) = offset;
  P_.setZero();
  const auto prior = [&](double size) { return size * size / (noise_m_ * noise_m_); };
  P_(0, 0) = prior(5e-3);
  int pair = 0;
  const auto add = [&](int n, int m, double size) {
    n_[pair] = n;
    m_[pair] = m;
    P_(1 + 2 * pair, 1 + 2 * pair) = P_(2 + 2 * pair, 2 + 2 * pair) = prior(size);
    ++pair;
  };
  for (int k = 1; k <= options_.respiration_harmonics; ++k) add(0, k, options_.respiration_m / (k * k));
  for (int n = 1; n <= cardiac_; ++n) add(n, 0, options_.cardiac_m / (n * n));
  for (int n = 1; n <= sidebands_; ++n)
    for (const int side : {1, -1}) add(n, side, options_.sideband_m / (n * n));
  open(cardiac_, true);
}

void FourierMotion::open(int cardiac_harmonics, bool sidebands) {
  const int cardiac = options_.respiration_harmonics + std::min(cardiac_harmonics, cardiac_);
  columns_ = 1 + 2 * (sidebands ? options_.respiration_harmonics + cardiac_ + 2 * sidebands_ : cardiac);
}

void FourierMotion::basis(double heart, double breath, Basis& h) const {
  h[0] = 1;
  int c = 1;
  const auto add = [&](const std::complex<double>& z) {
    h[c++] = z.real();
    h[c++] = z.imag();
  };
  const std::complex<double> u = turn(heart), v = turn(breath);
  std::complex<double> z = 1;
  for (int k = 1; k <= options_.respiration_harmonics; ++k) add(z *= v);
  z = 1;
  for (int n = 1; n <= cardiac_; ++n) add(z *= u);
  if (c >= columns_) return;
  z = 1;
  for (int n = 1; n <= sidebands_; ++n) {
    z *= u;
    add(z * v);
    add(z * std::conj(v));
  }
}

FourierMotion::Axes FourierMotion::value(const Basis& h) const {
  return h.head(columns_).transpose() * a_.topRows(columns_);
}

void FourierMotion::slopes(const Basis& h, Axes& by_heart, Axes& by_breath) const {
  by_heart.setZero();
  by_breath.setZero();
  for (int pair = 0; 1 + 2 * pair < columns_; ++pair) {
    const int c = 1 + 2 * pair;
    const Axes g = kTau * (h[c] * a_.row(c + 1) - h[c + 1] * a_.row(c));
    by_heart += n_[pair] * g;
    by_breath += m_[pair] * g;
  }
}

double FourierMotion::variance(const Basis& h) {
  auto Ph = Ph_.head(columns_);
  Ph.noalias() = P_.topLeftCorner(columns_, columns_) * h.head(columns_);
  return std::max(0.0, Ph.dot(h.head(columns_)));
}

void FourierMotion::update(const Basis& h, const Axes& innovation, double weight, double dt) {
  if (!(weight > 1e-6)) return;
  const double s = variance(h) + 1 / weight;
  auto Ph = Ph_.head(columns_);
  auto P = P_.topLeftCorner(columns_, columns_);
  a_.topRows(columns_).noalias() += Ph * (innovation / s);
  const double grow = std::exp(weight * dt / options_.memory_s), shrink = grow / s;
  for (int c = 0; c < columns_; ++c) P.col(c) = grow * P.col(c) - (shrink * Ph[c]) * Ph;  // stays symmetric
}

}  // namespace heartservo::servo
