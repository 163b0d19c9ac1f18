#pragma once
// The files that a motion may come from; read_motion() (motion_record.hpp) is what others call.
#include "servo/motion/motion_record.hpp"

namespace heartservo::servo {

/// `path` itself, or frames.csv in the folder of a run. Throws InputError for a folder without one.
std::filesystem::path motion_file(const std::filesystem::path& path);

/// The rows of a CSV or TUM file, times checked, without notes and period; any number of rows. Throws as read_motion().
MotionRecord read_rows(const std::filesystem::path& file, const std::string& group);

}  // namespace heartservo::servo
