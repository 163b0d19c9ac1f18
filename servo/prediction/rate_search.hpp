#pragma once
// Finds the beats and the rate of breathing in the last seconds of a motion, with no idea of either.
//
// The beat's period is the lag at which the motion best repeats itself, as pitch is found in speech (de Cheveigne and
// Kawahara, "YIN", J. Acoust. Soc. Am. 111, 2002): the smallest mean squared difference, with a preference for the
// shorter of two lags that do equally well. What is compared is a second difference over 0.14 s, in which breathing is
// small. Then each beat is found where it best resembles its neighbour, since beats are not equally long; and breathing
// is the rate whose harmonics, together with those of the beats, leave least (a spectral search by least squares).
// The work is cut in slices, so that no sample waits for it.
#include <Eigen/Core>
#include <array>
#include <span>

#include "servo/prediction/uniform_track.hpp"

namespace heartservo::servo {

class RateSearch {
 public:
  static constexpr double kSlowestBeat_hz = 0.62, kFastestBeat_hz = 3;  ///< 37 to 180 a minute
  static constexpr double kSlowestBreath_hz = 0.12, kFastestBreath_hz = 0.54;
  static constexpr double kShortest_s = 4.6;  ///< of motion, to search in
  static constexpr double kLongest_s = 8;

  RateSearch();

  /// Looks at what `track` holds now, its last kLongest_s at most.
  void begin(const UniformTrack& track);
  /// The same with the beats known: R peaks, s, increasing; four at least within what is searched.
  void begin(const UniformTrack& track, std::span<const double> r_peaks_s);
  /// One slice of the work (about 10 us). True when all is done.
  bool step();

  /// What was found, when done.
  bool found() const { return found_; }
  double beat_hz() const { return 1 / (period_ * step_s_); }
  double breath_hz() const { return breath_hz_; }
  /// Phases at a time, in cycles from the begin of what was searched.
  double beat_phase(double time_s) const;
  double breath_phase(double time_s) const { return breath_hz_ * (time_s - begin_s_); }
  double first_mark_s() const { return begin_s_ + step_s_ * marks_[static_cast<std::size_t>(first_mark_)]; }
  double last_mark_s() const { return begin_s_ + step_s_ * marks_[static_cast<std::size_t>(end_mark_ - 1)]; }
  double begin_s() const { return begin_s_; }
  /// How unlike one beat is the next: 0 the same, 1 as unlike as any two moments.
  double unlikeness() const { return unlikeness_; }

 private:
  static constexpr int kMost = 512, kLags = 160, kMarks = 40, kBreaths = 36;
  enum class Stage { LAGS, MARKS, BREATH, DONE };

  void lag_slice();
  void choose_period();
  double unlike(int at, int other, int length) const;
  double match(double from, double expected) const;
  void mark_slice();
  void begin_breath();
  void breath_slice();

  Stage stage_ = Stage::DONE;
  bool found_ = false;
  Eigen::Matrix<double, kMost, 3, Eigen::RowMajor> p_, curve_;  // motion, and its second difference
  int size_ = 0, reach_ = 0;
  double step_s_ = 0.016, begin_s_ = 0, period_ = 50, breath_hz_ = 0.25, unlikeness_ = 1;
  std::array<double, kLags> difference_{};
  int lag_ = 0, shortest_ = 0, longest_ = 0;
  std::array<double, kMarks> marks_{};  // steps
  int first_mark_ = 0, end_mark_ = 0;
  bool forward_ = true;
  int breath_ = 0;
  double best_left_ = 0;
};

}  // namespace heartservo::servo
