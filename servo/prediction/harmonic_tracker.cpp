#include "servo/prediction/harmonic_tracker.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::servo {

namespace {

constexpr double kStep_s = 0.016;      // of the motion that is searched, unless sampling is slower
constexpr double kBeatSigma_s = 0.01;  // of an R peak against the motion

}  // namespace

HarmonicOptions harmonic_options(const PredictorOptions& options, bool use_beats) {
  HarmonicOptions o;
  o.fourier.cardiac_harmonics = o.fourier.sidebands = options.harmonics;
  o.fourier.memory_s = options.memory_s;
  o.smallest_sigma_m = options.smallest_sigma_m;
  o.use_beats = use_beats;
  return o;
}

HarmonicTracker::HarmonicTracker(const HarmonicOptions& options)
    : options_(options), track_(768), filter_(options.fourier), samples_(kSamples) {}

void HarmonicTracker::search_again() {
  stage_ = Stage::GATHER;
  wait_until_s_ = last_s_;
}

HarmonicTracker::Axes HarmonicTracker::noise_of(const Axes& variance) const {
  const double least = options_.smallest_sigma_m * options_.smallest_sigma_m;
  Axes noise = variance;
  for (int i = 0; i < 3; ++i)
    if (!(noise[i] > least) || !std::isfinite(noise[i])) noise[i] = noise_.known() ? noise_.variance()[i] : 1e-8;
  return noise.cwiseMax(std::max(least, 1e-14));
}

void HarmonicTracker::observe(double time_s, const Axes& position, const Axes& variance) {
  noise_.add(time_s, position);
  if (count_ > 0) {
    const double dt = time_s - last_s_;
    period_s_ = count_ == 1 ? dt : period_s_ + std::clamp(dt - period_s_, -0.5 * period_s_, 0.1 * period_s_) * 0.1;
    // phases cannot be carried over any gap
    if (dt > 3 && stage_ != Stage::GATHER) search_again();
    if (dt > UniformTrack::kGap_s) begin_ = end_;
  }
  last_s_ = time_s;
  ++count_;
  if (count_ == 12) track_.restart(std::max(kStep_s, period_s_));
  if (count_ >= 12) track_.add(time_s, position);
  // a fast camera's samples are thinned for the memory alone
  if (end_ == begin_ || time_s - sample(end_ - 1).time_s > 0.0035) {
    samples_[end_++ % kSamples] = {time_s, position, noise_of(variance)};
    if (end_ - begin_ > kSamples) begin_ = end_ - kSamples;
    while (time_s - sample(begin_).time_s > kMemory_s) ++begin_;
  }
  if (stage_ == Stage::FOLLOW) {
    filter_.observe(time_s, position, noise_of(variance));
    if (options_.use_beats) use_beats();
    return;
  }
  const int slices = std::clamp(static_cast<int>(std::lround(period_s_ / 0.008)), 1, 12);
  for (int i = 0; i < slices && stage_ != Stage::FOLLOW; ++i) slice();
}

void HarmonicTracker::observe_beat(double r_peak_s) {
  if (!options_.use_beats || !std::isfinite(r_peak_s) ||
      (beat_count_ > 0 && !(r_peak_s > beats_[(beat_count_ - 1) % beats_.size()])))
    return;
  beats_[beat_count_++ % beats_.size()] = r_peak_s;
}

void HarmonicTracker::slice() {
  switch (stage_) {
    case Stage::GATHER:
      gather();
      break;
    case Stage::SEARCH:
      if (!search_.step() && !search_.step()) break;
      stage_ = search_.found() ? Stage::TEACH : Stage::GATHER;
      wait_until_s_ = last_s_ + 0.5;
      if (!search_.found()) break;
      next_ = first_after(search_.first_mark_s() - 0.4 / search_.beat_hz());
      filter_.start(sample(next_).position, std::sqrt(sample(next_).noise.mean()), search_.beat_hz(), period_s_);
      break;
    case Stage::TEACH:
      teach();
      break;
    case Stage::CATCH_UP:
      catch_up();
      break;
    case Stage::FOLLOW:
      break;
  }
}

void HarmonicTracker::gather() {
  if (count_ < 12 || last_s_ < wait_until_s_ || !noise_.known()) return;
  if (track_.size() * track_.step_s() < RateSearch::kShortest_s) return;
  if (options_.use_beats && beat_count_ >= 4) {
    std::array<double, 16> beats;
    const std::size_t n = std::min(beat_count_, beats.size());
    for (std::size_t i = 0; i < n; ++i) beats[i] = beats_[(beat_count_ - n + i) % beats_.size()];
    search_.begin(track_, std::span<const double>(beats.data(), n));
  } else {
    search_.begin(track_);
  }
  stage_ = Stage::SEARCH;
}

std::size_t HarmonicTracker::first_after(double time_s) const {
  std::size_t i = begin_;
  while (i + 1 < end_ && sample(i).time_s < time_s) ++i;
  return i;
}

void HarmonicTracker::teach() {
  // beyond the last beat found the phase is a guess
  const double until = search_.last_mark_s() + 0.8 / search_.beat_hz();
  for (int n = 0; n < 8; ++n) {
    if (next_ < begin_ || next_ >= end_ || sample(next_).time_s > until) {
      next_ = std::max(begin_, first_after(search_.first_mark_s() - 0.4 / search_.beat_hz()));
      const double time = sample(next_).time_s;
      filter_.track(time, search_.beat_phase(time), search_.beat_hz(), search_.breath_phase(time), search_.breath_hz());
      ++next_;
      beats_used_ = 0;
      stage_ = Stage::CATCH_UP;
      return;
    }
    const Sample& s = sample(next_++);
    filter_.teach(s.time_s, s.position, search_.beat_phase(s.time_s), search_.breath_phase(s.time_s));
  }
}

void HarmonicTracker::catch_up() {
  for (int n = 0; n < 5; ++n) {
    if (next_ >= end_) {
      stage_ = Stage::FOLLOW;
      return;
    }
    if (next_ < begin_) next_ = begin_;
    const Sample& s = sample(next_++);
    filter_.observe(s.time_s, s.position, s.noise);
    if (options_.use_beats) use_beats();
  }
}

void HarmonicTracker::use_beats() {
  if (beat_count_ > beats_.size()) beats_used_ = std::max(beats_used_, beat_count_ - beats_.size());
  while (beats_used_ < beat_count_) {
    const double peak = beats_[beats_used_ % beats_.size()];
    if (peak > filter_.time_s()) return;
    ++beats_used_;
    if (filter_.time_s() - peak < 0.5) filter_.observe_beat(peak, kBeatSigma_s);
  }
}

}  // namespace heartservo::servo
