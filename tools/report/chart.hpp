#pragma once
// Charts of many runs, drawn in the page by Chart.js (charts.js): a number over a number with its interval, boxes,
// points.
#include <cmath>
#include <string>
#include <vector>

namespace heartservo::tools {

/// `low` to `high` is drawn as a line through the point: its interval, or the whiskers of a box from `q1` to `q3` with
/// a line at `y`. NaN: none of it. In a chart of boxes x is the number of the category.
struct ChartPoint {
  double x = 0, y = 0, low = NAN, high = NAN, q1 = NAN, q3 = NAN;
  std::string label = {};  ///< shown when pointed at
};

struct ChartSeries {
  std::string label;
  std::vector<ChartPoint> points;
  bool is_front = false;  ///< a dashed staircase without marks: what no other point beats
};

struct ReportChart {
  enum class Kind { LINES, BOXES, POINTS };
  std::string title;
  Kind kind = Kind::LINES;
  std::string x_label, y_label, note;
  std::vector<std::string> categories = {};  ///< of boxes
  std::vector<ChartSeries> series = {};
  bool log_x = false, log_y = false;
};

/// For charts.js: [{"title", "kind", "x", "y", "log_x", "log_y", "categories", "series": [{"label", "front", "points":
/// [[x, y, low, high, q1, q3], ...], "names": [...]}]}, ...]; 6 significant digits, null for NaN.
std::string chart_data(const std::vector<ReportChart>& charts);

/// <figure>s with a <canvas> each.
std::string chart_figures(const std::vector<ReportChart>& charts);

}  // namespace heartservo::tools
