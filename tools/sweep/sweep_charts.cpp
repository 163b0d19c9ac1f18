#include "tools/sweep/sweep_charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/sweep/sweep_statistics.hpp"

namespace heartservo::tools {

namespace {

constexpr std::size_t kMostSeries = 14;  // that can be told apart: seven colours, with and without dashes
constexpr double kWide = 30;             // a range from here on is drawn by its logarithm

using Axes = std::vector<std::size_t>;

// The values of the axes `which` in a run: "mixture, 16".
std::string name_of(const std::vector<std::string>& values, const Axes& which) {
  std::string name;
  for (const std::size_t k : which) name += (name.empty() ? "" : ", ") + values[k];
  return name;
}

std::string title_of(const SweepPlan& plan, const Axes& which) {
  std::string title;
  for (const std::size_t k : which) title += (title.empty() ? "" : ", ") + plan.axes[k].key;
  return title;
}

std::size_t combinations(const SweepPlan& plan, const Axes& which) {
  std::size_t n = 1;
  for (const std::size_t k : which) n *= plan.axes[k].values.size();
  return n;
}

// Everything but the seed, axes of names first.
Axes axes_without_seed(const SweepPlan& plan) {
  Axes names, numbers;
  for (std::size_t k = 0; k < plan.axes.size(); ++k)
    if (plan.axes[k].key != "seed") (plan.axes[k].numeric ? numbers : names).push_back(k);
  names.insert(names.end(), numbers.begin(), numbers.end());
  return names;
}

// `which` without its last axes, so that there are not more combinations than `most`; the others are pooled.
Axes at_most(const SweepPlan& plan, Axes which, std::size_t most) {
  while (!which.empty() && combinations(plan, which) > most) which.pop_back();
  return which;
}

std::string pooled_note(const SweepPlan& plan, const Axes& all, const Axes& kept) {
  if (kept.size() == all.size()) return "";
  return fmt::format(" All {} are pooled.",
                     title_of(plan, Axes(all.begin() + static_cast<long>(kept.size()), all.end())));
}

// The values of a metric of what did not fail, by series and by place in it, in the order of the runs.
struct Grouped {
  std::vector<std::string> series, places;
  std::map<std::pair<std::size_t, std::size_t>, std::vector<double>> values;
};

std::size_t index_in(std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  names.push_back(name);
  return names.size() - 1;
}

Grouped grouped(const SweepPlan& plan, const SweepResults& results, std::size_t metric, const Axes& series,
                const Axes& places) {
  Grouped g;
  for (const auto& [run, r] : results) {
    if (r.status == "failed" || !std::isfinite(r.metrics[metric])) continue;
    const auto values = plan.values(run);
    const std::size_t s = index_in(g.series, name_of(values, series)), p = index_in(g.places, name_of(values, places));
    g.values[{s, p}].push_back(r.metrics[metric]);
  }
  return g;
}

bool is_wide(const std::vector<ChartSeries>& series, double ChartPoint::*member) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const auto& s : series)
    for (const auto& p : s.points)
      if (std::isfinite(p.*member)) low = std::min(low, p.*member), high = std::max(high, p.*member);
  return low > 0 && high / low >= kWide;
}

// By linear interpolation between the sorted values.
double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double more = below + 1 < sorted.size() ? sorted[below + 1] - sorted[below] : 0;
  return sorted[below] + (at - static_cast<double>(below)) * more;
}

ChartPoint median_point(double x, const std::vector<double>& values, const std::string& label) {
  const Interval i = median_interval(values);
  return {x, i.median, i.count > 1 ? i.low : NAN, i.count > 1 ? i.high : NAN, NAN, NAN, label};
}

ReportChart lines(const SweepPlan& plan, const SweepResults& results, std::size_t metric, std::size_t axis) {
  Axes others = axes_without_seed(plan);
  std::erase(others, axis);
  const Axes kept = at_most(plan, others, kMostSeries);
  const Grouped g = grouped(plan, results, metric, kept, {axis});
  ReportChart chart{fmt::format("{} against {}", plan.metrics[metric], plan.axes[axis].key), ReportChart::Kind::LINES,
                    plan.axes[axis].key, plan.metrics[metric], "Median over the seeds with its 95 % interval."};
  chart.note += pooled_note(plan, others, kept);
  for (std::size_t s = 0; s < g.series.size(); ++s) {
    ChartSeries series{g.series[s].empty() ? "all runs" : g.series[s], {}};
    for (std::size_t p = 0; p < g.places.size(); ++p)
      if (const auto found = g.values.find({s, p}); found != g.values.end())
        series.points.push_back(median_point(std::strtod(g.places[p].c_str(), nullptr), found->second,
                                             fmt::format("{} {}", plan.axes[axis].key, g.places[p])));
    std::sort(series.points.begin(), series.points.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
    chart.series.push_back(std::move(series));
  }
  chart.log_x = is_wide(chart.series, &ChartPoint::x);
  chart.log_y = is_wide(chart.series, &ChartPoint::y);
  return chart;
}

ReportChart boxes(const SweepPlan& plan, const SweepResults& results, std::size_t metric) {
  const Axes all = axes_without_seed(plan);
  const Axes places(all.begin(), all.begin() + static_cast<long>(std::min<std::size_t>(1, all.size())));
  const Axes others(all.begin() + static_cast<long>(places.size()), all.end());
  const Axes kept = at_most(plan, others, kMostSeries / 2);
  const Grouped g = grouped(plan, results, metric, kept, places);
  ReportChart chart{fmt::format("{} over the seeds", plan.metrics[metric]), ReportChart::Kind::BOXES,
                    title_of(plan, places), plan.metrics[metric],
                    "Boxes from the lower to the upper quartile with the median, whiskers to the least and the most."};
  chart.note += pooled_note(plan, others, kept);
  chart.categories = g.places;
  for (std::size_t s = 0; s < g.series.size(); ++s) {
    ChartSeries series{g.series[s].empty() ? "all runs" : g.series[s], {}};
    for (std::size_t p = 0; p < g.places.size(); ++p) {
      ChartPoint point{static_cast<double>(p), NAN, NAN, NAN, NAN, NAN, g.places[p]};
      if (const auto found = g.values.find({s, p}); found != g.values.end()) {
        std::vector<double> v = found->second;
        std::sort(v.begin(), v.end());
        point.y = quantile(v, 0.5), point.low = v.front(), point.high = v.back();
        point.q1 = quantile(v, 0.25), point.q3 = quantile(v, 0.75);
      }
      series.points.push_back(point);
    }
    chart.series.push_back(std::move(series));
  }
  chart.log_y = is_wide(chart.series, &ChartPoint::q1);
  return chart;
}

// The points that have less y than every point with less x.
ChartSeries front_of(const std::vector<ChartSeries>& series) {
  std::vector<ChartPoint> all;
  for (const auto& s : series) all.insert(all.end(), s.points.begin(), s.points.end());
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return std::pair(a.x, a.y) < std::pair(b.x, b.y); });
  ChartSeries front{"no setting is better", {}, true};
  for (const auto& p : all)
    if (front.points.empty() || p.y < front.points.back().y) front.points.push_back({p.x, p.y});
  return front;
}

ReportChart pareto(const SweepPlan& plan, const SweepResults& results, std::size_t metric, std::size_t time) {
  const Axes all = axes_without_seed(plan), kept = at_most(plan, all, kMostSeries);
  ReportChart chart{
      fmt::format("{} against {}", plan.metrics[metric], plan.metrics[time]), ReportChart::Kind::POINTS,
      plan.metrics[time], plan.metrics[metric],
      "A mark a setting: medians over the seeds. Towards the lower left is better; the staircase joins the "
      "settings that none beats in both."};
  // a colour for each value of the first axes, a mark for every setting
  const Axes colours = at_most(plan, kept, 7).empty() ? kept : at_most(plan, kept, 7);
  std::map<std::string, std::vector<double>> times, values;
  std::vector<std::pair<std::string, std::string>> order;  // colour, setting
  for (const auto& [run, r] : results) {
    if (r.status == "failed" || !std::isfinite(r.metrics[metric]) || !std::isfinite(r.metrics[time])) continue;
    const std::string name = name_of(plan.values(run), all);
    if (!times.contains(name)) order.emplace_back(name_of(plan.values(run), colours), name);
    times[name].push_back(r.metrics[time]);
    values[name].push_back(r.metrics[metric]);
  }
  std::vector<std::string> names;
  for (const auto& [colour, name] : order) {
    const std::size_t s = index_in(names, colour);
    if (s == chart.series.size()) chart.series.push_back({colour.empty() ? "all runs" : colour, {}});
    chart.series[s].points.push_back(median_point(median_interval(times[name]).median, values[name], name));
  }
  chart.log_x = is_wide(chart.series, &ChartPoint::x);
  chart.log_y = is_wide(chart.series, &ChartPoint::y);
  if (order.size() > 1) chart.series.push_back(front_of(chart.series));
  return chart;
}

}  // namespace

std::vector<ReportChart> sweep_charts(const SweepPlan& plan, const SweepResults& results) {
  std::vector<std::size_t> shown{0};
  const auto at = [&](const auto& is) {
    return static_cast<std::size_t>(std::find_if(plan.metrics.begin(), plan.metrics.end(), is) - plan.metrics.begin());
  };
  const std::size_t residual = at([](const std::string& m) { return m == "residual.rms_mm"; });
  const std::size_t time = at([](const std::string& m) { return m.starts_with("timing."); });
  if (residual != 0 && residual < plan.metrics.size()) shown.push_back(residual);
  std::vector<ReportChart> charts;
  for (const std::size_t metric : shown) {
    for (std::size_t k = 0; k < plan.axes.size(); ++k)
      if (plan.axes[k].numeric && plan.axes[k].key != "seed" && plan.axes[k].values.size() > 1)
        charts.push_back(lines(plan, results, metric, k));
    charts.push_back(boxes(plan, results, metric));
    if (time < plan.metrics.size() && time != metric) charts.push_back(pareto(plan, results, metric, time));
  }
  std::erase_if(charts, [](const ReportChart& chart) { return chart.series.empty(); });  // everything failed
  return charts;
}

}  // namespace heartservo::tools
