#include "tools/report/thinning.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::tools {

TimeTable thinned(const TimeTable& table, const std::set<std::string>& columns, std::size_t values) {
  std::vector<std::string> names{table.columns().front()};
  std::vector<std::span<const double>> kept{table.time_s()};
  for (const auto& name : table.columns())
    if (name != names.front() && columns.contains(name)) {
      names.push_back(name);
      kept.push_back(table.column(name));
    }
  const std::size_t rows = table.rows(), most_rows = std::max<std::size_t>(values / kept.size(), 2 * kept.size());
  TimeTable result(names, std::min(rows, most_rows));
  std::vector<double> row(kept.size());
  const auto keep = [&](std::size_t i) {
    for (std::size_t c = 0; c < kept.size(); ++c) row[c] = kept[c][i];
    result.append(row);
  };
  if (rows <= most_rows) {
    for (std::size_t i = 0; i < rows; ++i) keep(i);
    return result;
  }
  const std::size_t stretches = std::max<std::size_t>(1, most_rows / (2 * kept.size()));
  std::set<std::size_t> chosen;
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t from = s * rows / stretches, to = (s + 1) * rows / stretches;
    chosen.insert(from);
    for (std::size_t c = 1; c < kept.size(); ++c) {
      std::size_t least = to, largest = to;
      for (std::size_t i = from; i < to; ++i) {
        if (!std::isfinite(kept[c][i])) continue;
        if (least == to || kept[c][i] < kept[c][least]) least = i;
        if (largest == to || kept[c][i] > kept[c][largest]) largest = i;
      }
      if (least != to) chosen.insert({least, largest});
    }
  }
  chosen.insert(rows - 1);
  for (const std::size_t i : chosen) keep(i);
  return result;
}

}  // namespace heartservo::tools
