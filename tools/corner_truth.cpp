#include "tools/corner_truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

std::vector<std::string> corner_columns() {
  std::vector<std::string> names{"time_s"};
  for (int i = 0; i < 4; ++i)
    for (const char* axis : {"u_px", "v_px"}) names.push_back(fmt::format("truth/corner{}/{}", i, axis));
  return names;
}

std::vector<std::string> target_columns() { return {"truth/target/u_px", "truth/target/v_px"}; }

Eigen::Vector2d region_centre(const tracking::Quad& corners_px, const tracking::Camera& lens) {
  tracking::Quad plane = corners_px;
  if (lens.fx > 0)
    for (auto& corner : plane) corner = lens.normalise(corner);
  const Eigen::Matrix3d H = tracking::homography_between(tracking::rectangle(-1, -1, 2, 2), plane);
  const Eigen::Vector2d centre = H.col(2).hnormalized();
  return lens.fx > 0 ? lens.to_pixel(lens.distort(centre)) : centre;
}

CornerTruth::CornerTruth(const std::string& file) : table_(TimeTable::read_csv(file)) {
  for (const auto& name : corner_columns())
    if (!table_.has(name))
      throw InputError(fmt::format("{}: column {} is missing; expected what 'heartservo render' writes", file, name));
  if (table_.has(target_columns()[0]) != table_.has(target_columns()[1]))
    throw InputError(file + ": of truth/target/u_px and v_px one is missing; expected what 'heartservo render' writes");
}

double CornerTruth::frame_rate_hz() const {
  const auto times = table_.time_s();
  double shortest_s = INFINITY;
  for (std::size_t i = 1; i < times.size(); ++i) shortest_s = std::min(shortest_s, times[i] - times[i - 1]);
  return 1 / shortest_s;
}

std::optional<std::size_t> CornerTruth::row_at(double time_s) const {
  constexpr double kSameTime_s = 1e-6;
  const auto times = table_.time_s();
  const auto row = std::lower_bound(times.begin(), times.end(), time_s - kSameTime_s);
  if (row == times.end() || *row > time_s + kSameTime_s) return std::nullopt;
  return static_cast<std::size_t>(row - times.begin());
}

Eigen::Vector2d CornerTruth::target_at(double time_s) const {
  const auto row = row_at(time_s);
  if (!row || !has_target()) return Eigen::Vector2d::Constant(NAN);
  return {table_.column(target_columns()[0])[*row], table_.column(target_columns()[1])[*row]};
}

std::optional<tracking::Quad> CornerTruth::at(double time_s) const {
  const auto row = row_at(time_s);
  if (!row) return std::nullopt;
  const auto names = corner_columns();
  tracking::Quad quad;
  for (std::size_t k = 0; k < 4; ++k) {
    quad[k] = {table_.column(names[1 + 2 * k])[*row], table_.column(names[2 + 2 * k])[*row]};
    if (!quad[k].allFinite()) return std::nullopt;
  }
  return quad;
}

}  // namespace heartservo::tools
