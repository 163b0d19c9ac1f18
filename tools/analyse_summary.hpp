#pragma once
// The numbers of `analyse`: as JSON, and as tables for people.
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "servo/motion/motion_analysis.hpp"
#include "tools/report/report.hpp"

namespace heartservo::tools {

/// A record and what was found in it.
struct AnalysisRun {
  std::string source;
  servo::MotionRecord record;
  servo::AnalysisOptions options;
  servo::MotionAnalysis measured;
  std::optional<servo::MotionAnalysis> truth;  ///< the same of the record's truth
};

nlohmann::json analyse_summary(const AnalysisRun& run);

/// The lines as the paper's Table 3 has them, and the axes; where the record has a truth, its values beside them.
std::vector<ReportTable> analyse_tables(const nlohmann::json& summary);

}  // namespace heartservo::tools
