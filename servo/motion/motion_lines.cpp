#include "servo/motion/motion_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace heartservo::servo {

namespace {

using Family = MotionLine::Family;
constexpr int kHarmonics = 12, kBreathHarmonics = 4;
constexpr double kLeastOther_percent = 2;
constexpr double kAboveNoise = 12;  // of the density of such a peak: a spectrum of noise has peaks of its own
constexpr double kOther = 0.1;      // of the height of a peak near it: an uneven heart's lines have ragged skirts

class Finder {
 public:
  Finder(const Rhythm& rhythm, const std::array<Spectrum, 3>& spectra, const Eigen::Vector3d& noise)
      : rhythm_(rhythm), spectra_(spectra), noise_(noise), blur_(1 / spectra[0].segment_s) {
    for (int a = 0; a < 3; ++a) total_[a] = spectra[static_cast<std::size_t>(a)].power(0, INFINITY);
  }

  std::vector<MotionLine> lines(double least_percent) {
    const double half_rate = spectra_[0].frequency_hz(spectra_[0].density.size() - 1);
    for (int k = 1; k <= kHarmonics && rhythm_.heart_hz > 0; ++k)
      add(Family::HEART, k, 0, k * rhythm_.heart_hz, 0.95 * half_rate);
    // a breath's harmonics end where the heart's lines and their sidebands begin
    const double heart_from =
        rhythm_.heart_hz > 0 ? rhythm_.heart_hz - 0.5 * rhythm_.respiration_hz : kHighestRespiration_hz * 2;
    for (int k = 1; k <= kBreathHarmonics && rhythm_.respiration_hz > 0; ++k)
      add(Family::RESPIRATION, k, 0, k * rhythm_.respiration_hz, heart_from);
    add_others();
    drop(least_percent);
    divide();
    for (int a = 0; a < 3; ++a) {
      double sum = 0;
      for (const auto& line : lines_) sum += power(line, a);
      for (auto& line : lines_) {
        line.amplitude_m[a] = std::sqrt(2 * power(line, a));
        line.density_percent[a] = sum > 0 ? 100 * power(line, a) / sum : 0;
      }
    }
    return lines_;
  }

 private:
  void add(Family family, int harmonic, int breaths, double f, double below) {
    if (f < below) lines_.push_back({family, harmonic, breaths, f, f - blur_, f + blur_, {}, {}});
  }

  double power(const MotionLine& line, int a) const {
    const double power = spectra_[static_cast<std::size_t>(a)].power(line.low_hz, line.high_hz);
    return std::max(0.0, power - noise_[a] * (line.high_hz - line.low_hz));
  }
  double percent(const MotionLine& line) const {
    double largest = 0;
    for (int a = 0; a < 3; ++a)
      if (total_[a] > 0) largest = std::max(largest, 100 * power(line, a) / total_[a]);
    return largest;
  }

  // How far a peak may lie from a family's line and still belong to it.
  double reach(double f) const { return 2 * blur_ + 0.03 * f; }

  // Density at index i, each axis relative to its power, added up.
  double density(std::size_t i) const {
    double sum = 0;
    for (Eigen::Index a = 0; a < 3; ++a)
      if (total_[a] > 0) sum += spectra_[static_cast<std::size_t>(a)].density[i] / total_[a];
    return sum;
  }
  double noise_level() const {
    double sum = 0;
    for (Eigen::Index a = 0; a < 3; ++a)
      if (total_[a] > 0) sum += noise_[a] / total_[a];
    return sum;
  }
  double highest(double from, double to) const {
    double highest = 0;
    for (std::size_t i = 0; i < spectra_[0].density.size(); ++i)
      if (spectra_[0].frequency_hz(i) >= from && spectra_[0].frequency_hz(i) <= to)
        highest = std::max(highest, density(i));
    return highest;
  }

  // Breath's harmonics that are no more than the slope of a neighbour are none.
  bool stands_out(const MotionLine& line) const {
    if (line.family != Family::RESPIRATION || line.harmonic == 1) return true;
    const double f = line.frequency_hz, half = 0.5 * rhythm_.respiration_hz, wide = 0.25 * half;
    if (half < 2 * blur_) return percent(line) > kLeastOther_percent;  // too near to tell a slope from a line
    return highest(f - wide, f + wide) >
           2 * std::max(highest(f - half - wide, f - half + wide), highest(f + half - wide, f + half + wide));
  }

  // Peaks that no family explains.
  void add_others() {
    const auto known = lines_;
    for (std::size_t i = 1; i + 1 < spectra_[0].density.size(); ++i) {
      const double f = spectra_[0].frequency_hz(i), y0 = density(i - 1), y1 = density(i), y2 = density(i + 1);
      if (f < std::max(kLowestRespiration_hz, 1.5 * blur_) || y1 < y0 || y1 <= y2) continue;
      constexpr double kHannWidth = 1.5;  // a line's power is its density times this many resolutions
      if (y1 < kAboveNoise * noise_level()) continue;
      const double around = 6 * blur_ + 0.1 * f;
      if (100 * y1 * kHannWidth * blur_ < kLeastOther_percent || y1 < kOther * highest(f - around, f + around))
        continue;
      if (std::any_of(known.begin(), known.end(),
                      [&](const auto& l) { return std::abs(l.frequency_hz - f) < reach(f); }))
        continue;
      MotionLine line;
      line.frequency_hz = f + spectra_[0].step_hz * 0.5 * (y0 - y2) / (y0 - 2 * y1 + y2);
      line.low_hz = line.frequency_hz - blur_, line.high_hz = line.frequency_hz + blur_;
      name_sideband(line);
      lines_.push_back(line);
    }
  }

  void name_sideband(MotionLine& line) const {
    if (rhythm_.heart_hz <= 0 || rhythm_.respiration_hz <= 0) return;
    for (int k = 1; k <= kHarmonics; ++k)
      for (const int m : {-1, 1, -2, 2})
        if (std::abs(k * rhythm_.heart_hz + m * rhythm_.respiration_hz - line.frequency_hz) < blur_) {
          line.family = Family::SIDEBAND, line.harmonic = k, line.breaths = m;
          return;
        }
  }

  // Weak lines, and those that are no more than the noise's own unevenness.
  void drop(double least_percent) {
    std::erase_if(lines_, [&](const MotionLine& line) {
      if (percent(line) < least_percent || !stands_out(line)) return true;
      for (int a = 0; a < 3; ++a)
        if (power(line, a) > 4 * noise_[a] * (line.high_hz - line.low_hz)) return false;
      return true;
    });
    std::sort(lines_.begin(), lines_.end(), [](auto& a, auto& b) { return a.frequency_hz < b.frequency_hz; });
  }

  void divide() {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      auto& line = lines_[i];
      const double last = rhythm_.heart_hz > 0 ? 0.5 * rhythm_.heart_hz : 2 * blur_;
      line.low_hz = i == 0 ? 0.5 * line.frequency_hz : 0.5 * (lines_[i - 1].frequency_hz + line.frequency_hz);
      line.high_hz =
          i + 1 == lines_.size() ? line.frequency_hz + last : 0.5 * (line.frequency_hz + lines_[i + 1].frequency_hz);
      if (line.family == Family::HEART) line.low_hz = std::max(line.low_hz, line.frequency_hz - last);
      if (line.family == Family::HEART) line.high_hz = std::min(line.high_hz, line.frequency_hz + last);
    }
  }

  Rhythm rhythm_;
  const std::array<Spectrum, 3>& spectra_;
  Eigen::Vector3d noise_, total_ = Eigen::Vector3d::Zero();
  double blur_;
  std::vector<MotionLine> lines_;
};

}  // namespace

std::string name_of(const MotionLine& line) {
  switch (line.family) {
    case Family::RESPIRATION:
      return fmt::format("respiration {}", line.harmonic);
    case Family::HEART:
      return fmt::format("heart {}", line.harmonic);
    case Family::SIDEBAND:
      return fmt::format("heart {} {} respiration {}", line.harmonic, line.breaths < 0 ? '-' : '+',
                         std::abs(line.breaths));
    case Family::OTHER:
      break;
  }
  return "other";
}

std::vector<MotionLine> find_lines(const Rhythm& rhythm, const std::array<Spectrum, 3>& spectra,
                                   const Eigen::Vector3d& noise_density, double least_percent) {
  return Finder(rhythm, spectra, noise_density).lines(least_percent);
}

}  // namespace heartservo::servo
