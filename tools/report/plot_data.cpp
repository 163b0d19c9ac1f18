#include "tools/report/plot_data.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>

#include "tools/report/thinning.hpp"

namespace heartservo::tools {

namespace {

constexpr std::size_t kMostValues = 400000;  // of a page, about 4 MB

void append_column(fmt::memory_buffer& text, std::span<const double> values, bool time) {
  const auto out = std::back_inserter(text);
  text.push_back('[');
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text.push_back(',');
    if (!std::isfinite(values[i]))
      fmt::format_to(out, "null");
    else if (time)
      fmt::format_to(out, FMT_COMPILE("{:.9g}"), values[i]);
    else
      fmt::format_to(out, FMT_COMPILE("{:.6g}"), values[i]);
  }
  text.push_back(']');
}

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// The tables in the order of their first use, and which of their columns are drawn.
struct Used {
  std::vector<const TimeTable*> tables;
  std::map<const TimeTable*, std::set<std::string>> columns;

  std::size_t add(const TimeTable* table, const std::string& column) {
    if (table == nullptr) throw std::invalid_argument("report: a plot or a state strip has no table");
    (void)table->column(column);  // throws for an unknown one
    columns[table].insert(column);
    const auto found = std::find(tables.begin(), tables.end(), table);
    if (found != tables.end()) return static_cast<std::size_t>(found - tables.begin());
    tables.push_back(table);
    return tables.size() - 1;
  }
};

}  // namespace

std::string plot_data(const Report& report) {
  Used used;
  nlohmann::json plots = nlohmann::json::array();
  for (const auto& plot : report.plots) {
    nlohmann::json series = nlohmann::json::array();
    const TimeTable* table = plot.table != nullptr ? plot.table : report.table;
    if (table == nullptr) throw std::invalid_argument("report: a plot has no table");
    const std::string& x = table->columns()[0];
    std::size_t index = used.add(table, x);
    for (const auto& s : plot.series) {
      index = used.add(table, s.column);
      series.push_back({{"label", s.label}, {"column", s.column}, {"truth", s.is_truth}});
    }
    plots.push_back({{"title", plot.title},
                     {"unit", plot.y_label},
                     {"scale", plot.scale},
                     {"log_from", plot.log_from},
                     {"about_mean", plot.about_mean},
                     {"x", x},
                     {"table", index},
                     {"series", series}});
  }
  nlohmann::json states = nlohmann::json::array();
  for (const auto& state : report.states) {
    used.add(report.table, "time_s");
    states.push_back(
        {{"table", used.add(report.table, state.column)}, {"column", state.column}, {"label", state.label}});
  }
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{{\"tables\":[");
  for (std::size_t i = 0; i < used.tables.size(); ++i) {
    text.push_back(i > 0 ? ',' : ' ');
    bool first = true;
    const auto& columns = used.columns[used.tables[i]];
    const TimeTable table = thinned(*used.tables[i], columns, kMostValues / used.tables.size());
    for (const auto& name : columns) {
      fmt::format_to(out, "{}\n{}:", first ? "{" : ",", quoted(name));
      append_column(text, table.column(name), name == table.columns()[0]);
      first = false;
    }
    text.push_back('}');
  }
  const auto dumped = [](const nlohmann::json& json) {
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  };
  fmt::format_to(out, "],\n\"plots\":{},\n\"states\":{}}}", dumped(plots), dumped(states));
  return fmt::to_string(text);
}

}  // namespace heartservo::tools
