#pragma once
#include <string>
#include <vector>

#include "tracking/settings/fields.hpp"

namespace heartservo::servo {

/// Limits on every command, what ends a run, and what happens when the target is lost.
struct GuardOptions {
  // limits
  double max_speed = 0.3;            ///< m/s
  double max_acceleration = 15;      ///< m/s^2
  double max_step_m = 0.0025;        ///< m per period
  double workspace_radius_m = 0.05;  ///< m
  double max_force_n = 4;            ///< N
  int bad_commands_to_stop = 3;
  double max_error_m = 0.02;  ///< m
  double max_error_s = 0.25;  ///< s
  // lost targets
  double coast_s = 0.15;          ///< s
  double coast_beyond_m = 0.004;  ///< m
  double hold_s = 0.5;            ///< s
  double retract_m = 0.01;        ///< m
  double retract_speed = 0.03;    ///< m/s
  double approach_speed = 0.05;   ///< m/s
  double max_target_speed = 0.6;  ///< m/s
  int resume_frames = 5;
  // watchdogs
  double max_prediction_s = 0.3;  ///< s
  double command_life_s = 0.1;    ///< s
  double max_frame_age_s = 0;     ///< s; 0: not watched
  double max_chain_s = 0;         ///< s; 0: not watched
  int slow_frames_to_stop = 10;

  void fields(FieldVisitor& v);
  std::vector<std::string> validate() const;
};

}  // namespace heartservo::servo
