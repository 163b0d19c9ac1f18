#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/time_table.hpp"
#include "tracking/camera/camera.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::tools {

/// Columns time_s, truth/corner0/u_px ... truth/corner3/v_px: written by `render`, read by `track --truth`.
std::vector<std::string> corner_columns();
/// Columns truth/target/u_px, truth/target/v_px: the same for the region's centre; a file need not have them.
std::vector<std::string> target_columns();

/// px: where the centre of a flat region lies whose corners are these (not their mean, seen from the side). `lens`
/// without focal length: none.
Eigen::Vector2d region_centre(const tracking::Quad& corners_px, const tracking::Camera& lens);

/// True corners of the region over time, and its centre.
class CornerTruth {
 public:
  /// Throws InputError: unreadable, or a column is missing.
  explicit CornerTruth(const std::string& file);

  /// Of the rows, from the shortest time between two of them; 0 where there are fewer.
  double frame_rate_hz() const;

  /// None where the file has no row within 1 microsecond of the time, or an empty cell.
  std::optional<tracking::Quad> at(double time_s) const;

  /// Does the file have the centre?
  bool has_target() const { return table_.has(target_columns()[0]); }
  /// px; NaN where it is not known.
  Eigen::Vector2d target_at(double time_s) const;

 private:
  std::optional<std::size_t> row_at(double time_s) const;

  TimeTable table_;
};

}  // namespace heartservo::tools
