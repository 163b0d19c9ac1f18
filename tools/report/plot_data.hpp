#pragma once
// The numbers of a report's plots as JSON, for the script of the page.
#include <string>

#include "tools/report/report.hpp"

namespace heartservo::tools {

/// {"tables":[{"time_s":[...],...}],"plots":[...],"states":[{"table":0,"column":"...","label":"..."},...]}: every row
/// of the columns that are drawn, or, of a long run, fewer rows with the extremes among them; 6 significant digits (9 for time), null for "no value". Throws std::invalid_argument
/// for a column that its table lacks, or a plot without a table.
std::string plot_data(const Report& report);

}  // namespace heartservo::tools
