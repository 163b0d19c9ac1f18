#include "servo/safety/guard_options.hpp"

namespace heartservo::servo {

void GuardOptions::fields(FieldVisitor& v) {
  v.field({"max_speed", "m/s", "fastest commanded speed of the tip", 1e-3, 10}, max_speed);
  v.field({"max_acceleration", "m/s^2", "largest change of the commanded velocity per second", 1e-2, 1e4},
          max_acceleration);
  v.field({"max_step_m", "m", "longest way commanded within one period", 1e-6, 1}, max_step_m);
  v.field({"workspace_radius_m", "m", "a tip further than this from where the run began stops the loop", 1e-3, 10},
          workspace_radius_m);
  v.field({"max_force_n", "N", "a larger contact force stops the loop", 1e-3, 1000}, max_force_n);
  v.field({"bad_commands_to_stop", "", "this many commands in a row that are not finite stop the loop", 1, 1000},
          bad_commands_to_stop);
  v.field({"max_error_m", "m",
           "a tip that is further than this from its goal for max_error_s, while the target is seen, stops the loop",
           1e-4, 10},
          max_error_m);
  v.field({"max_error_s", "s", "see max_error_m", 0, 10}, max_error_s);
  v.field({"coast_s", "s", "how long a lost target is followed on its prediction before the tool holds still", 0, 10},
          coast_s);
  v.field({"coast_beyond_m", "m",
           "a lost target whose prediction goes further than this beyond all places where it was seen is not followed",
           0, 10},
          coast_beyond_m);
  v.field({"hold_s", "s", "how long the tool then stands where the target was last seen before it retracts", 0, 1000},
          hold_s);
  v.field({"retract_m", "m",
           "how far it retracts along its axis, half of the workspace at most; 0: it goes on standing", 0, 0.2},
          retract_m);
  v.field({"retract_speed", "m/s", "fastest on the way back to the last safe place and while retracting", 1e-3, 1},
          retract_speed);
  v.field({"approach_speed", "m/s", "fastest on the way to the goal when following is resumed", 1e-3, 1},
          approach_speed);
  v.field({"max_target_speed", "m/s", "a target that jumps faster than this from one frame to the next is not believed",
           0.01, 100},
          max_target_speed);
  v.field({"resume_frames", "", "frames in a row in which a lost target must be seen before it is followed again", 1,
           1000},
          resume_frames);
  v.field({"max_prediction_s", "s",
           "furthest ahead a prediction is trusted; a scene whose delays need more is refused", 1e-3, 10},
          max_prediction_s);
  v.field({"command_life_s", "s", "the robot stops by itself when no new command has come for so long", 1e-3, 10},
          command_life_s);
  v.field({"max_frame_age_s", "s", "a live frame that arrives later than this is not used; 0: not watched", 0, 10},
          max_frame_age_s);
  v.field({"max_chain_s", "s", "computing time of a frame above this counts as slow; 0: not watched", 0, 10},
          max_chain_s);
  v.field({"slow_frames_to_stop", "", "this many slow frames in a row stop the loop", 1, 10000}, slow_frames_to_stop);
}

std::vector<std::string> GuardOptions::validate() const {
  std::vector<std::string> problems;
  const auto must_be_positive = [&](const char* name, double value) {
    if (!(value > 0)) problems.push_back(std::string("loop.guard.") + name + " must be above 0");
  };
  must_be_positive("max_speed", max_speed);
  must_be_positive("max_acceleration", max_acceleration);
  must_be_positive("max_step_m", max_step_m);
  must_be_positive("workspace_radius_m", workspace_radius_m);
  must_be_positive("max_force_n", max_force_n);
  if (max_step_m > workspace_radius_m)
    problems.emplace_back("loop.guard.max_step_m is longer than loop.guard.workspace_radius_m");
  return problems;
}

}  // namespace heartservo::servo
