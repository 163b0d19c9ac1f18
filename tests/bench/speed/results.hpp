#pragma once
// What heartservo_speed_goals has measured: rows with the goal beside them, printed and kept as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace heartservo::bench {

inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return NAN;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

class Results {
 public:
  /// `goal`: at most that much, or, with `at_least`, at least; NaN: none, for the record. `note`: how it was measured.
  void add(const std::string& name, double value, const std::string& unit, double goal, bool at_least = false,
           const std::string& note = "") {
    const bool met = std::isnan(goal) || (at_least ? value >= goal : value <= goal);
    fmt::print("{:<52}{:>11} {:<6}{:>12}{:>7}  {}\n", name, fmt::format("{:.4g}", value), unit,
               std::isnan(goal) ? "" : fmt::format("{} {:.4g}", at_least ? ">=" : "<=", goal),
               std::isnan(goal) ? "" : met ? "met" : "MISSED", note);
    std::fflush(stdout);
    nlohmann::json row{{"name", name}, {"value", value}, {"unit", unit}, {"note", note}};
    if (!std::isnan(goal)) row["goal"] = goal, row["at_least"] = at_least, row["met"] = met;
    all["rows"].push_back(row);
  }
  void heading(const std::string& title) { fmt::print("\n{}\n", title); }

  nlohmann::json all{{"command", "heartservo_speed_goals"}, {"rows", nlohmann::json::array()}};
};

}  // namespace heartservo::bench
