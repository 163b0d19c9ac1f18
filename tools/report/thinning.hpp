#pragma once
// A plot is some thousand pixels wide: more rows than that make a page slow and large, and show nothing more. What must
// stay are the extremes.
#include <set>
#include <string>

#include "tools/time_table.hpp"

namespace heartservo::tools {

/// `table` with these columns only (the first one among them in any case), and when it has more than `values` values in
/// them, with fewer rows: of equal stretches of rows the first, and those with the least and the largest value of any
/// column. Infinite and missing values do not count.
TimeTable thinned(const TimeTable& table, const std::set<std::string>& columns, std::size_t values);

}  // namespace heartservo::tools
