#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/time_table.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::tools {

/// Columns time_s, truth/corner0/u_px ... truth/corner3/v_px: written by `render`, read by `track --truth`.
std::vector<std::string> corner_columns();

/// True corners of the region over time.
class CornerTruth {
 public:
  /// Throws InputError: unreadable, or a column is missing.
  explicit CornerTruth(const std::string& file);

  /// Of the rows, from the shortest time between two of them; 0 where there are fewer.
  double frame_rate_hz() const;

  /// None where the file has no row within 1 microsecond of the time, or an empty cell.
  std::optional<tracking::Quad> at(double time_s) const;

 private:
  TimeTable table_;
};

}  // namespace heartservo::tools
