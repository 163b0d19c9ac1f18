#pragma once
// Other files than CSV that a motion may come from; read_motion_record() knows them.
#include "servo/motion/motion_record.hpp"

namespace heartservo::servo {

/// `path` itself, or frames.csv in the folder of a run. Throws InputError for a folder without one.
std::string motion_file(const std::string& path);

/// A trajectory in TUM format: `time x y z qx qy qz qw` a line (s, m), '#' begins a comment. Throws InputError with
/// file and line.
MotionRecord read_tum(const std::string& file);

}  // namespace heartservo::servo
