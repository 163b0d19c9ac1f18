#pragma once
// The numbers of a `track` run for people: in the terminal and in the report.
#include <nlohmann/json.hpp>
#include <string>

#include "tools/report/report.hpp"

namespace heartservo::tools {

/// A comparison that the paper printed, beside what this run gave.
struct PaperTable {
  ReportTable table;
  nlohmann::json summary;  ///< the same for summary.json
};

/// The side-by-side table of the trackers; columns of errors only where a truth was there.
ReportTable tracker_table(const nlohmann::json& summary);

/// Table 5 of Sauvee et al. 2007 (artificial sequence `table5`): mean and standard deviation of the error beside those
/// of the run's trackers. `noise_grey` (standard deviation) and `speculars` (number) are the run's, for the note.
PaperTable paper_table_5(const nlohmann::json& trackers, double noise_grey, int speculars);

/// Their Fig. 7 (artificial sequence `circle`): which trackers lose the pattern, and when.
PaperTable paper_figure_7(const nlohmann::json& trackers, int speculars);

/// A table as text for a terminal: columns of numbers flush right, and the note below in lines of 100 letters.
std::string terminal_text(const ReportTable& table, bool with_note);

}  // namespace heartservo::tools
