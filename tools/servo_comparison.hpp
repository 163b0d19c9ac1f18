#pragma once
// Predictors and control laws side by side: a loop for every pair, one table.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/report/report.hpp"
#include "tools/servo_run.hpp"

namespace heartservo::tools {

struct ServoComparison {
  nlohmann::json rows = nlohmann::json::array();  ///< a row a pair, in the order they were run
  ServoOutcome best;                              ///< the run with the smallest residual that no guard stopped
  bool interrupted = false;
};

/// Ends early when interrupted. Throws ConfigError, InputError.
ServoComparison compare(const ServoRequest& request, const std::vector<std::string>& predictors,
                        const std::vector<std::string>& controllers);

/// For the terminal and for the report.
std::string comparison_text(const nlohmann::json& rows);
ReportTable comparison_table(const nlohmann::json& rows);

}  // namespace heartservo::tools
