#include "tools/trajectory.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>

#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

void write_tum(const TimeTable& table, const std::filesystem::path& file) {
  std::array<std::span<const double>, 8> columns;
  std::size_t i = 0;
  for (const char* name :
       {"time_s", "measured/x_m", "measured/y_m", "measured/z_m", "pose/qx", "pose/qy", "pose/qz", "pose/qw"})
    columns[i++] = table.column(name);
  std::ofstream out(file);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (std::isnan(columns[1][row])) continue;
    std::string line;
    for (const auto& column : columns) line += fmt::format("{}{:.9g}", line.empty() ? "" : " ", column[row]);
    out << line << '\n';
  }
  if (!out.flush()) throw ConfigError(file.string() + ": cannot be written; check space and permissions");
}

}  // namespace heartservo::tools
