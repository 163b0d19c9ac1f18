#pragma once
// Motion of one spot of a beating heart: displacement and tilt as functions of time, known in closed form.
#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/heart/beats.hpp"
#include "sim/heart/heart_profile.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

/// No heart: the surface stands still in itself and rides on a rail along the camera's axis, to and fro at constant
/// speed (section 4.1).
struct RailOptions {
  double travel_m = 0.02;
  double period_s = 4;
  Eigen::Vector3d turn_rad{0, 0, 0};

  void fields(FieldVisitor& v) {
    v.field({"travel_m", "m", "from the nearest to the furthest place; the middle is surface.anchor_m", 0, 0.1},
            travel_m);
    v.field({"period_s", "s", "there and back, beginning at the nearest place", 0.01, 1e4}, period_s);
    v.field({"turn_rad", "rad", "how the surface is turned on the rail: rotation vector, camera frame", -3.2, 3.2},
            turn_rad);
  }
};

struct HeartMotionOptions {
  double sine_hz = 1, sine_amplitude_m = 0.002;
  int sine_axis = 0;
  std::string profile = "sharp";
  double heart_rate_hz = profile::kHeartRate_hz;
  double respiration_rate_hz = profile::kRespiration_hz;
  double amplitude_scale = 1;
  double rotation_rad = 0.04;
  double beat_variability = 0.02;
  double beat_correlation = 0.3;
  double respiration_variability = 0.005;
  double breathing_modulation = 0.1;
  double ectopic_share = 0, ectopic_advance = 0.3;
  std::string beats;
  double beats_rate_hz = 360;
  RailOptions rail;

  void fields(FieldVisitor& v) {
    v.choice({"profile", "",
              "lines of motion: the six of Table 3, those and sharp harmonics (Table 4), or none; sine: see sine_hz; "
              "rail: no heart, see motion.rail"},
             profile, {"six_line", "sharp", "still", "sine", "rail"});
    v.field({"sine_hz", "Hz", "profile sine: frequency", 0.01, 100}, sine_hz);
    v.field({"sine_amplitude_m", "m", "profile sine: amplitude", 0, 0.01}, sine_amplitude_m);
    v.field({"sine_axis", "", "profile sine: 0, 1 or 2 for the camera's x, y or z", 0, 2}, sine_axis);
    v.field({"heart_rate_hz", "Hz", "mean heart rate", 0.3, 2}, heart_rate_hz);
    v.field({"respiration_rate_hz", "Hz", "mean respiration rate", 0.05, 1}, respiration_rate_hz);
    v.field({"amplitude_scale", "", "1 is the paper's heart: 11 mm peak to peak along z", 0, 3}, amplitude_scale);
    v.field({"rotation_rad", "rad", "largest tilt about each axis", 0, 0.2}, rotation_rad);
    v.field({"beat_variability", "", "standard deviation of the beat period, relative", 0, 0.3}, beat_variability);
    v.field({"beat_correlation", "", "correlation of successive beat periods", -0.95, 0.95}, beat_correlation);
    v.field({"respiration_variability", "", "standard deviation of the respiration period, relative", 0, 0.3},
            respiration_variability);
    v.field({"breathing_modulation", "", "by how much breathing changes the beat's amplitude", 0, 0.5},
            breathing_modulation);
    v.field({"ectopic_share", "", "share of beats that come early, each followed by a pause", 0, 0.5}, ectopic_share);
    v.field({"ectopic_advance", "", "by which share of the beat's period they come early", 0, 0.6}, ectopic_advance);
    v.field({"beats", "",
             "file of R peaks to beat by instead of drawn ones, relative to the scene: CSV with time_s or, in its last "
             "column, sample numbers; or WFDB annotations (.atr); the run begins at ecg.start_s"},
            beats);
    v.field({"beats_rate_hz", "Hz", "samples per second where motion.beats counts samples; that of ecg.record if given",
             1, 100000},
            beats_rate_hz);
    v.group("rail", "of profile rail: to and fro along the camera's axis (section 4.1)", rail);
  }

  /// Every problem at once, empty when usable.
  std::vector<std::string> validate() const;
};

/// Deterministic in (options, seed, duration); const methods may be called from any thread. Beyond the duration the
/// motion goes on, at constant rates.
class HeartMotion {
 public:
  /// Throws ConfigError on options that do not validate.
  HeartMotion(const HeartMotionOptions& options, std::uint64_t seed, double duration_s);

  /// Beats at given R peaks (s), for example from a recorded ECG, instead of drawn ones.
  HeartMotion(const HeartMotionOptions& options, std::uint64_t seed, double duration_s, std::vector<double> r_peaks_s);

  /// Camera frame, m, about zero in the mean.
  Eigen::Vector3d displacement(double t) const;

  /// Tilt about the spot, a rotation in the camera frame.
  Eigen::Matrix3d rotation(double t) const;

  double respiration_phase(double t) const { return respiration_.phase(t); }  ///< [0, 1)
  double cardiac_phase(double t) const { return heart_.phase(t); }            ///< [0, 1), 0 at the R peak

  /// Strength of the beat at t: about 1, modulated by breathing; 0 for a heart that stands still.
  double beat_strength(double t) const;

  /// Times of the R peaks, s, increasing.
  const std::vector<double>& beats() const { return heart_.marks(); }

 private:
  using Line = std::complex<double>;  // amplitude and phase: Re(line e^{i angle})

  double strength(const std::complex<double>& breath) const;
  bool on_rail() const { return options_.profile == "rail"; }

  HeartMotionOptions options_;
  PhaseClock heart_;
  PhaseClock respiration_;
  std::array<std::array<Line, 2>, 3> respiration_lines_;
  std::array<std::array<Line, profile::kCardiacLines>, 3> heart_lines_;
  int harmonics_ = 0;
};

}  // namespace heartservo::sim
