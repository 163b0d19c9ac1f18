#include "servo/ecg/r_peak_detector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tracking/settings/errors.hpp"

namespace heartservo::servo {

namespace {

constexpr double kSigma_s = 0.013, kReach = 3.7;  // half a kernel: 48 ms
constexpr double kGroup_s = 0.07;                 // extrema this near are one complex
constexpr double kRefractory_s = 0.25;            // the heart cannot beat again before
constexpr double kLearning_s = 2, kSilence_s = 4;
constexpr double kShare = 0.35;  // of the way from noise to beats lies the threshold
constexpr double kLookBack = 1.66, kLookBackShare = 0.4;
constexpr double kTwave_s = 0.36, kTwaveShare = 0.5;
constexpr std::size_t kCandidates = 64;

// Of the first `count` values; 0 for none.
double median(std::array<double, 8> values, std::size_t count) {
  count = std::min(count, values.size());
  if (count == 0) return 0;
  for (std::size_t i = count; i < values.size(); ++i) values[i] = INFINITY;  // they sort to the end
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

RPeakDetector::RPeakDetector(double rate_hz) : rate_hz_(rate_hz) {
  if (!(rate_hz >= 50))
    throw ConfigError(fmt::format("an ECG of {} samples a second; R peaks need 50 or more", rate_hz));
  half_ = static_cast<std::size_t>(std::ceil(kReach * kSigma_s * rate_hz));
  double sum = 0, power = 0;
  for (std::size_t i = 0; i <= 2 * half_; ++i) {
    const double x = (static_cast<double>(i) - static_cast<double>(half_)) / (kSigma_s * rate_hz);
    kernel_.push_back((1 - x * x) * std::exp(-0.5 * x * x));
    sum += kernel_.back();
  }
  for (double& k : kernel_) k -= sum / static_cast<double>(kernel_.size()), power += std::max(k, 0.0);
  for (double& k : kernel_) k /= power;  // a plateau that fills the positive lobe answers with its height
  samples_.assign(kernel_.size(), 0);
  since_beat_.reserve(kCandidates);
  learning_until_ = kLearning_s * rate_hz;
}

double RPeakDetector::delay_s() const { return seconds(static_cast<double>(half_) + 1) + kGroup_s; }

double RPeakDetector::respond() const {
  double sum = 0;
  const std::size_t n = kernel_.size(), begin = count_ % n;  // the oldest sample
  for (std::size_t i = 0; i < n; ++i) sum += kernel_[i] * samples_[(begin + i) % n];
  return sum;
}

double RPeakDetector::beat_size() const { return median(sizes_, beats_); }
double RPeakDetector::threshold() const { return noise_ + kShare * (beat_size() - noise_); }
double RPeakDetector::mean_interval() const { return beats_ < 2 ? 0 : median(intervals_, beats_ - 1); }

std::optional<RPeak> RPeakDetector::next(double time_s, double value) {
  if (std::isfinite(value)) last_value_ = value;
  if (count_ == 0) std::fill(samples_.begin(), samples_.end(), last_value_);
  samples_[count_ % samples_.size()] = last_value_;
  ++count_;
  time_s_ = time_s;
  response_ = {response_[1], response_[2], respond()};
  const double before = response_[0], here = response_[1], after = response_[2];
  if (count_ > 2 && std::abs(here) > std::abs(before) && std::abs(here) >= std::abs(after)) {
    const double bend = before - 2 * here + after;
    const double shift = bend == 0 ? 0 : std::clamp(0.5 * (before - after) / bend, -0.5, 0.5);
    look_at({static_cast<double>(count_) - 2 - static_cast<double>(half_) + shift, here});
  }
  const double now = static_cast<double>(count_) - 1 - static_cast<double>(half_);
  if (pending_ && seconds(now - pending_->index) >= kGroup_s) {
    const Extremum found = *pending_;
    pending_.reset();
    decide(found);
  }
  if (learning_until_ > 0 && static_cast<double>(count_) >= learning_until_) learn();
  if (learning_until_ == 0) look_back();
  if (known_.empty()) return std::nullopt;
  const RPeak peak = known_.front();
  known_.pop_front();
  return peak;
}

// Of several extrema in one complex the largest counts; of nearly equal ones that which has the sign of other beats.
void RPeakDetector::look_at(const Extremum& extremum) {
  const auto worth = [&](const Extremum& e) {
    const bool usual = e.size * sign_ > 0;
    return std::abs(e.size) * (std::abs(sign_) > 0.5 ? (usual ? 1.5 : 1) : 1);
  };
  if (!pending_ || worth(extremum) > worth(*pending_)) pending_ = extremum;
}

void RPeakDetector::decide(const Extremum& found) {
  const double size = std::abs(found.size), since = seconds(found.index - last_beat_);
  const bool enough = learning_until_ == 0 && size >= threshold() && since >= kRefractory_s &&
                      (since >= kTwave_s || size >= kTwaveShare * beat_size());
  if (enough) {
    accept(found, false);
    return;
  }
  if (since < kRefractory_s && learning_until_ == 0) return;  // part of the beat before
  if (since_beat_.size() == kCandidates) since_beat_.erase(since_beat_.begin());
  since_beat_.push_back(found);
  if (learning_until_ == 0) noise_ += 0.125 * (std::min(size, beat_size()) - noise_);
}

void RPeakDetector::accept(const Extremum& extremum, bool looked_back) {
  // the response is known at `index` + half a kernel; time_s_ belongs to the newest sample
  const double age = static_cast<double>(count_) - 1 - extremum.index;
  known_.push_back({time_s_ - seconds(age), time_s_, std::abs(extremum.size), looked_back});
  const double interval = extremum.index - last_beat_;
  if (beats_ > 0) intervals_[(beats_ - 1) % intervals_.size()] = interval;
  // one giant (an artefact) must not deafen the detector
  const double usual = beat_size();
  sizes_[beats_ % sizes_.size()] = beats_ == 0 ? std::abs(extremum.size) : std::min(std::abs(extremum.size), 3 * usual);
  ++beats_;
  sign_ += 0.2 * ((extremum.size > 0 ? 1 : -1) - sign_);
  last_beat_ = extremum.index;
  since_beat_.clear();
}

// What the first seconds held: their largest extrema are beats, if they stand out of the rest.
void RPeakDetector::learn() {
  std::vector<double> all;
  for (const auto& e : since_beat_) all.push_back(std::abs(e.size));
  std::sort(all.begin(), all.end());
  const double largest = all.empty() ? 0 : all.back();
  // No more extrema than beats can be: an ECG without noise, in which every extremum is a beat.
  const bool only_beats = all.size() >= 2 && static_cast<double>(all.size()) <= kLearning_s / kRefractory_s &&
                          all.front() > 0.5 * largest;
  const double middle = all.empty() || only_beats ? 0 : all[all.size() / 2];
  if (!(largest > 3 * middle) || largest <= 0) {  // silence, or nothing but noise
    learning_until_ = static_cast<double>(count_) + 0.5 * kLearning_s * rate_hz_;
    const double from = static_cast<double>(count_) - kLearning_s * rate_hz_;
    std::erase_if(since_beat_, [&](const Extremum& e) { return e.index < from; });
    return;
  }
  learning_until_ = 0;
  beats_ = 0;
  noise_ = middle;
  sign_ = 0;
  double signs = 0;
  for (const auto& e : since_beat_)
    if (std::abs(e.size) > 0.5 * largest) signs += e.size > 0 ? 1 : -1;
  sign_ = signs > 0 ? 0.6 : -0.6;
  const std::vector<Extremum> candidates = since_beat_;
  const double before = last_beat_;
  for (const auto& e : candidates)
    if (std::abs(e.size) > 0.5 * largest && seconds(e.index - std::max(last_beat_, before)) >= kRefractory_s)
      accept(e, true);
}

void RPeakDetector::look_back() {
  const double now = static_cast<double>(count_) - 1 - static_cast<double>(half_), pause = now - last_beat_;
  const double mean = mean_interval();
  if (mean > 0 && pause > kLookBack * mean && !since_beat_.empty()) {
    const Extremum* best = nullptr;
    for (const auto& e : since_beat_) {
      const double since = seconds(e.index - last_beat_);
      if (since >= kTwave_s && (best == nullptr || std::abs(e.size) > std::abs(best->size))) best = &e;
    }
    if (best != nullptr && std::abs(best->size) >= kLookBackShare * threshold() && std::abs(best->size) > 2 * noise_) {
      const Extremum found = *best;
      accept(found, true);
      return;
    }
  }
  if (seconds(pause) > kSilence_s) {  // a lead that came off, or another gain: start anew
    learning_until_ = static_cast<double>(count_) + 0.5 * kLearning_s * rate_hz_;
    const double from = static_cast<double>(count_) - kLearning_s * rate_hz_;
    std::erase_if(since_beat_, [&](const Extremum& e) { return e.index < from; });
  }
}

}  // namespace heartservo::servo
