#pragma once
#include <filesystem>

#include "tools/time_table.hpp"

namespace heartservo::tools {

/// trajectory.tum: `time x y z qx qy qz qw` a line (m; camera frame), for rows that have a pose. From the columns
/// measured/x_m ... and pose/qx ... . Throws ConfigError when the file cannot be written.
void write_tum(const TimeTable& table, const std::filesystem::path& file);

}  // namespace heartservo::tools
