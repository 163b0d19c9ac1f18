#pragma once
// The page of the whole reproduction, from the run folders of its experiments.
#include <deque>
#include <filesystem>
#include <vector>

#include "tools/paper/experiments.hpp"
#include "tools/report/report.hpp"

namespace heartservo::tools {

/// The report, and the tables that its plots point to.
struct PaperPage {
  Report report;
  std::deque<TimeTable> tables;
};

/// `runs`: the folder with a run folder for each experiment, and `motion1`, `motion2` of `analyse`. Fills `page`, which
/// must stay where it is. Throws InputError when a run is missing.
void fill_paper_page(const std::filesystem::path& runs, const std::vector<Experiment>& experiments, PaperPage& page);

}  // namespace heartservo::tools
