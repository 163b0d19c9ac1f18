#pragma once
// What a sweep shows: its first metric, and the residual where that is another one, over every numeric axis with the
// interval of the median; boxes of the seeds; and the residual against the time per frame, with the settings that none
// beats.
#include <vector>

#include "tools/report/chart.hpp"
#include "tools/sweep/sweep_report.hpp"

namespace heartservo::tools {

std::vector<ReportChart> sweep_charts(const SweepPlan& plan, const SweepResults& results);

}  // namespace heartservo::tools
