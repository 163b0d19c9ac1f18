#pragma once
// frames.csv of a servo run: one row a frame, of what the loop saw and did and of what truly was.
#include <vector>

#include "tools/time_table.hpp"

namespace heartservo::servo {
struct LoopRecord;
struct TruthSample;
}  // namespace heartservo::servo

namespace heartservo::tools {

/// An empty table with the run's columns and room for `rows`. `measured/...` is the target as the loop measured it, so
/// that the file is also a motion record. `live`: with the camera's stamps, and how old a frame was when it was used.
TimeTable make_loop_table(std::size_t rows, bool live = false);

void append(TimeTable& table, const servo::LoopRecord& record, const servo::TruthSample& truth);

/// The table with the goal's motion about its mean added (motion/x_m, ..., motion/u_px, ...), for plots.
TimeTable with_motion(const TimeTable& table);

/// The rows of the last `seconds`.
TimeTable tail(const TimeTable& table, double seconds);

}  // namespace heartservo::tools
