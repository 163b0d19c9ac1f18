#pragma once
// Several runs on one page.
#include <vector>

#include "tools/report/report.hpp"
#include "tools/stored_run.hpp"

namespace heartservo::tools {

/// Names that tell the runs apart: those of their folders, with a number where several are called the same.
std::vector<std::string> labels_of(const std::vector<StoredRun>& runs);

/// `column` of every run that has it, over the time of the one with the most rows: each run's value nearest in time,
/// NaN beyond its ends. Columns are named LABEL/`column`.
TimeTable together(const std::vector<StoredRun>& runs, const std::vector<std::string>& columns);

/// What differs between the summaries: a row for each number (mm, ms, px, percent ... as the summary has it) and name,
/// a column a run. Rows that are equal in all runs are left out when `differing`.
ReportTable summary_table(const std::vector<StoredRun>& runs, bool differing);

/// The page. `table`: together(runs, compared_columns(runs)); it must live until the report is written.
Report comparison_report(const std::vector<StoredRun>& runs, const TimeTable& table);
std::vector<std::string> compared_columns(const std::vector<StoredRun>& runs);

}  // namespace heartservo::tools
