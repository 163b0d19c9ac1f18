#include "servo/prediction/harmonic_filter.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::servo {

namespace {

constexpr double kSoftness = 0.8;
constexpr int kFirstHarmonics = 6;
constexpr double kFirstCorrelation_s = 0.08, kSettling_s = 6;
constexpr double kLearning_s = 3;    // after so long the model is good enough to tell the unusual
constexpr double kAnotherBeat = 20;  // chi^2 with 3 degrees of freedom: one in 6000 by chance
constexpr double kAnotherStretch =
    1;                        // standard deviation: of a beat half as long, diastole runs at more than twice its rate
constexpr double kUsual = 9;  // a rare misfit counts as three standard deviations in what the model leaves

double near_zero(double cycles) { return cycles - std::round(cycles); }
}  // namespace

HarmonicFilter::HarmonicFilter(const FourierOptions& fourier) : motion_(fourier), h_(motion_.make_basis()) {}

void HarmonicFilter::start(const Axes& position, double noise_m, double beat_hz, double period_s) {
  motion_.start(position, noise_m, static_cast<int>(0.4 / (period_s * beat_hz)));
  motion_.open(kFirstHarmonics, false);
  residual_.setConstant(1e-6);
  taught_ = 0;
}

void HarmonicFilter::teach(double time_s, const Axes& position, double heart, double breath) {
  motion_.basis(heart, breath, h_);
  motion_.update(h_, position - motion_.value(h_), 1, taught_ > 0 ? time_s - time_s_ : 0);
  const Axes left = position - motion_.value(h_);
  residual_ += 0.01 * (left.cwiseAbs2() - residual_);
  time_s_ = time_s;
  ++taught_;
}

void HarmonicFilter::track(double time_s, double heart, double beat_hz, double breath, double breath_hz) {
  for (std::size_t i = 0; i < kClocks; ++i) {
    BeatModel model;
    model.anchor = static_cast<double>(i % kAnchors) / kAnchors;
    model.softness = kSoftness;
    clocks_[i].start(model, heart, beat_hz, 0.03, 0.02);
    score_[i] = 0;
  }
  best_ = 0;
  spacing_ = 1.0 / kAnchors;
  focused_s_ = time_s;
  seen_end_ = learnt_ = learnable_ = 0;
  last_ = {time_s, heart};
  from_ = to_ = last_;
  turns_ = peaks_ = 0;
  breath_.start(breath, breath_hz, 0.02, 0.02);
  time_s_ = started_s_ = time_s;
}

void HarmonicFilter::focus(double spacing) {
  const BeatClock best = clocks_[best_];
  const double score = score_[best_];
  constexpr std::size_t kMiddle = kClocks / 2;
  for (std::size_t i = 0; i < kClocks; ++i) {
    clocks_[i] = best;
    BeatModel model = best.model();
    model.anchor += spacing * (static_cast<double>(i) - static_cast<double>(kMiddle));
    clocks_[i].set_model(model);
    score_[i] = score;
  }
  best_ = kMiddle;
  spacing_ = spacing;
}

void HarmonicFilter::observe(double time_s, const Axes& position, const Axes& noise) {
  const double dt = time_s - time_s_;
  time_s_ = time_s;
  for (auto& clock : clocks_) clock.advance(dt);
  breath_.advance(dt);
  const double phase = clocks_[best_].phase(), breath = breath_.phase();
  motion_.basis(phase, breath, h_);
  innovation_ = position - motion_.value(h_);
  Axes by_heart, by_breath;
  motion_.slopes(h_, by_heart, by_breath);
  const double share = motion_.variance(h_);
  // What the coefficients do not explain stays for a while: many samples tell no more about it than one.
  const double correlated =
      1 + (kFirstCorrelation_s * std::exp(-(time_s - started_s_) / kSettling_s)) / std::max(dt, 1e-3);
  const Axes r = noise.array() * (1 + share) + correlated * (residual_ - noise).array().max(0.0);
  const double age = time_s - started_s_;
  if (age > 3 && age - dt <= 3) motion_.open(motion_.cardiac_harmonics(), false);
  if (age > 6 && age - dt <= 6) motion_.open(motion_.cardiac_harmonics(), true);
  double chi2 = 0;
  for (int j = 0; j < 3; ++j)
    chi2 += innovation_[j] * innovation_[j] /
            (by_heart[j] * by_heart[j] * clocks_[best_].phase_variance() + r[j] +
             by_breath[j] * by_breath[j] * breath_.phase_variance());
  if (age > kLearning_s && chi2 > kAnotherBeat)  // an early beat: the learnt spread of beats does not hold for it
    for (auto& clock : clocks_) clock.doubt(kAnotherStretch);
  const double fade = std::exp(-dt / 15.0);
  for (std::size_t i = 0; i < kClocks; ++i) {
    BeatClock& clock = clocks_[i];
    double log_likelihood = 0;
    if (std::abs(near_zero(clock.phase() - phase)) > 0.05) clock.set_phase(phase);
    for (int j = 0; j < 3; ++j) {
      const double e = innovation_[j] - by_heart[j] * near_zero(clock.phase() - phase);
      const double s = by_heart[j] * by_heart[j] * clock.phase_variance() + r[j] +
                       by_breath[j] * by_breath[j] * breath_.phase_variance();
      log_likelihood -= 0.5 * (std::min(e * e / s, 25.0) + std::log(s / r[j]));
      clock.update(e, by_heart[j], s - by_heart[j] * by_heart[j] * clock.phase_variance());
    }
    if (age > 0.5) score_[i] = fade * score_[i] + log_likelihood;
  }
  const auto best = std::max_element(score_.begin(), score_.end());
  const double heart_variance = clocks_[best_].phase_variance();
  if (*best > score_[best_] + 3) best_ = static_cast<std::size_t>(best - score_.begin());
  if (peaks_ > 0) {
    spacing_ = 0;
  } else if (time_s - focused_s_ > 4) {
    if (spacing_ > 0.05)
      focus(1.0 / 40);
    else if (best_ < 3 || best_ + 3 >= kClocks)
      focus(spacing_);
    else if (spacing_ > 0.011)
      focus(0.5 * spacing_);
    focused_s_ = time_s;
  }
  const double moved = near_zero(clocks_[best_].phase() - phase);
  for (int j = 0; j < 3; ++j)
    breath_.update(innovation_[j] - by_heart[j] * moved - by_breath[j] * (breath_.phase() - breath), by_breath[j],
                   r[j] + by_heart[j] * by_heart[j] * heart_variance);
  motion_.basis(clocks_[best_].phase(), breath_.phase(), h_);
  const Axes left = position - motion_.value(h_);
  Axes usual = left.cwiseAbs2();
  if (age > kLearning_s) usual = usual.cwiseMin(kUsual * residual_);
  residual_ += std::min(1.0, dt / std::clamp(0.5 * age, 0.3, 4.0)) * (usual - residual_);
  seen_[seen_end_++ % kSeen] = {time_s, breath_.phase(), position};
  if (clocks_[best_].turns() != turns_ || time_s - last_.time_s > 0.8) {
    turns_ = clocks_[best_].turns();
    add_knot(clocks_[best_].phase());
  }
  learn();
}

void HarmonicFilter::add_knot(double phase) {
  while (learnt_ < learnable_) learn();
  from_ = last_;
  to_ = last_ = {time_s_, phase};
  learnable_ = seen_end_;
  if (seen_end_ - learnt_ > kSeen) learnt_ = seen_end_ - kSeen;
}

void HarmonicFilter::learn() {
  for (int n = 0; n < 2 && learnt_ < learnable_; ++n) {
    const Seen& s = seen_[learnt_++ % kSeen];
    const double share = (s.time_s - from_.time_s) / (to_.time_s - from_.time_s);
    motion_.basis(from_.phase + share * (to_.phase - from_.phase), s.breath, h_);
    const double dt =
        learnt_ > 1 && learnt_ - 2 + kSeen > seen_end_ ? s.time_s - seen_[(learnt_ - 2) % kSeen].time_s : 0;
    motion_.update(h_, s.position - motion_.value(h_), 1,
                   dt * std::clamp(40 / (0.5 * (s.time_s - started_s_) + 2), 1.0, 20.0));
  }
}

// Where the best clock was at a time between the last knot but one and now.
double HarmonicFilter::phase_at(double time_s) const {
  const Knot now{time_s_, clocks_[best_].phase()};
  const Knot &a = time_s < last_.time_s ? from_ : last_, &b = time_s < last_.time_s ? last_ : now;
  if (!(b.time_s > a.time_s)) return b.phase - clocks_[best_].rate_hz() * (b.time_s - time_s);
  return a.phase + (b.phase - a.phase) * (time_s - a.time_s) / (b.time_s - a.time_s);
}

void HarmonicFilter::observe_beat(double r_peak_s, double sigma_s) {
  const double phase = phase_at(r_peak_s);
  BeatModel model = clocks_[best_].model();
  ++peaks_;
  if (peaks_ == 1) model.anchor = phase;
  const double off = near_zero(model.anchor - phase);
  if (std::abs(off) < 0.12) {
    // the phase is better known from the motion; what the peaks tell is where in it systole begins
    model.anchor = phase + off * (1 - 1.0 / std::min(peaks_, 20));
    for (auto& clock : clocks_) clock.set_model(model);
    return;
  }
  // the phase was lost: systole began at the peak
  const double heart = model.anchor + clocks_[best_].rate_hz() * (time_s_ - r_peak_s);
  for (auto& clock : clocks_) clock.restart(clocks_[best_], heart, sigma_s * clocks_[best_].rate_hz());
  last_ = from_ = to_ = {time_s_, heart};
  learnt_ = learnable_ = seen_end_;
}

HarmonicEstimate HarmonicFilter::predict(double time_s) {
  HarmonicEstimate result;
  double heart_variance, breath_variance, rate;
  const double dt = std::max(0.0, time_s - time_s_);
  const double heart = clocks_[best_].foresee(dt, heart_variance, rate), breath = breath_.foresee(dt, breath_variance);
  motion_.basis(heart, breath, h_);
  result.position = motion_.value(h_);
  Axes by_heart, by_breath;
  motion_.slopes(h_, by_heart, by_breath);
  result.velocity = rate * by_heart + breath_.rate_hz() * by_breath;
  result.variance = by_heart.cwiseAbs2() * heart_variance + by_breath.cwiseAbs2() * breath_variance;
  return result;
}

}  // namespace heartservo::servo
