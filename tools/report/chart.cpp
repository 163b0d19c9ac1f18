#include "tools/report/chart.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tools/report/markup.hpp"

namespace heartservo::tools {

namespace {

using markup::escaped;
using nlohmann::json;

json short_number(double v) {
  if (!std::isfinite(v)) return nullptr;
  return std::strtod(fmt::format("{:.6g}", v).c_str(), nullptr);
}

const char* name_of(ReportChart::Kind kind) {
  return kind == ReportChart::Kind::LINES ? "lines" : kind == ReportChart::Kind::BOXES ? "boxes" : "points";
}

}  // namespace

std::string chart_data(const std::vector<ReportChart>& charts) {
  json all = json::array();
  for (const auto& chart : charts) {
    json series = json::array();
    for (const auto& s : chart.series) {
      json points = json::array(), names = json::array();
      for (const auto& p : s.points) {
        json point = json::array();
        for (const double v : {p.x, p.y, p.low, p.high, p.q1, p.q3}) point.push_back(short_number(v));
        points.push_back(point);
        names.push_back(p.label);
      }
      series.push_back({{"label", s.label}, {"front", s.is_front}, {"points", points}, {"names", names}});
    }
    all.push_back({{"title", chart.title},
                   {"kind", name_of(chart.kind)},
                   {"x", chart.x_label},
                   {"y", chart.y_label},
                   {"log_x", chart.log_x},
                   {"log_y", chart.log_y},
                   {"categories", chart.categories},
                   {"series", series}});
  }
  return all.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string chart_figures(const std::vector<ReportChart>& charts) {
  std::string html;
  for (std::size_t i = 0; i < charts.size(); ++i) {
    html += fmt::format("<figure>\n<h2>{}</h2>\n", escaped(charts[i].title));
    if (!charts[i].note.empty()) html += fmt::format("<p class=\"note\">{}</p>\n", escaped(charts[i].note));
    html += fmt::format(
        "<div class=\"chart\"><canvas id=\"chart{}\" role=\"img\" aria-label=\"{}\"></canvas></div>\n</figure>\n", i,
        escaped(charts[i].title));
  }
  return html;
}

}  // namespace heartservo::tools
