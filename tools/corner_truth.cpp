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

CornerTruth::CornerTruth(const std::string& file) : table_(TimeTable::read_csv(file)) {
  for (const auto& name : corner_columns())
    if (!table_.has(name))
      throw InputError(fmt::format("{}: column {} is missing; expected what 'heartservo render' writes", file, name));
}

double CornerTruth::frame_rate_hz() const {
  const auto times = table_.time_s();
  double shortest_s = INFINITY;
  for (std::size_t i = 1; i < times.size(); ++i) shortest_s = std::min(shortest_s, times[i] - times[i - 1]);
  return 1 / shortest_s;
}

std::optional<tracking::Quad> CornerTruth::at(double time_s) const {
  constexpr double kSameTime_s = 1e-6;
  const auto times = table_.time_s();
  const auto row = std::lower_bound(times.begin(), times.end(), time_s - kSameTime_s);
  if (row == times.end() || *row > time_s + kSameTime_s) return std::nullopt;
  const auto i = static_cast<std::size_t>(row - times.begin());
  const auto names = corner_columns();
  tracking::Quad quad;
  for (std::size_t k = 0; k < 4; ++k) {
    quad[k] = {table_.column(names[1 + 2 * k])[i], table_.column(names[2 + 2 * k])[i]};
    if (!quad[k].allFinite()) return std::nullopt;
  }
  return quad;
}

}  // namespace heartservo::tools
