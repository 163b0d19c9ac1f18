#include "tools/sweep/sweep_charts.hpp"

#include <gtest/gtest.h>

#include "tests/support/message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/tools/sweep/synthetic_sweep.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {
namespace {

using Kind = ReportChart::Kind;

TEST(SweepCharts, LinesBoxesAndThePareto) {
  const StoredSweep sweep = test::synthetic_sweep();
  const auto charts = sweep_charts(sweep.plan, sweep.results);
  ASSERT_EQ(charts.size(), 3u);
  const ReportChart& lines = charts[0];
  EXPECT_EQ(lines.kind, Kind::LINES);
  EXPECT_EQ(lines.x_label, "latency_ms");
  ASSERT_EQ(lines.series.size(), 4u);
  EXPECT_EQ(lines.series[3].label, "mixture");
  ASSERT_EQ(lines.series[0].points.size(), 4u);
  const ChartPoint& p = lines.series[0].points[2];
  EXPECT_EQ(p.x, 32);
  EXPECT_NEAR(p.y, 3.2 * 1.15, 1e-12) << "the median of five seeds";
  EXPECT_GE(p.low, 3.2 * 1.05 - 1e-12);
  EXPECT_LE(p.high, 3.2 * 1.25 + 1e-12);
  EXPECT_LT(p.low, p.y);
  EXPECT_TRUE(lines.log_y) << "from 0.1 to 8";
  EXPECT_FALSE(lines.log_x);
  const ReportChart& boxes = charts[1];
  EXPECT_EQ(boxes.kind, Kind::BOXES);
  EXPECT_EQ(boxes.categories, sweep.plan.axes[0].values);
  ASSERT_EQ(boxes.series.size(), 4u) << "a latency each";
  const ChartPoint& box = boxes.series[0].points[0];
  EXPECT_NEAR(box.low, 0.8 * 1.05, 1e-12);
  EXPECT_NEAR(box.q1, 0.8 * 1.10, 1e-12);
  EXPECT_NEAR(box.y, 0.8 * 1.15, 1e-12);
  EXPECT_NEAR(box.q3, 0.8 * 1.20, 1e-12);
  EXPECT_NEAR(box.high, 0.8 * 1.25, 1e-12);
  EXPECT_NEAR(boxes.series[1].points[0].low, 1.6 * 1.05, 1e-12) << "without the third seed, which failed";
  EXPECT_NEAR(boxes.series[1].points[0].y, 1.6 * 1.15, 1e-12);
  EXPECT_NEAR(boxes.series[1].points[0].q1, 1.6 * 1.0875, 1e-12);
}

TEST(SweepCharts, TheFrontIsWhatNothingBeats) {
  StoredSweep sweep = test::synthetic_sweep();
  sweep.plan.axes.erase(sweep.plan.axes.begin() + 1);
  sweep.results.clear();
  const double residual[]{4, 2, 3, 1}, time[]{1, 2, 3, 4};
  for (std::uint64_t i = 0; i < 20; ++i) sweep.results[i] = {i, "done", {residual[i / 5], 0, time[i / 5]}, 1, ""};
  const auto charts = sweep_charts(sweep.plan, sweep.results);
  ASSERT_EQ(charts.size(), 2u) << "no numeric axis but the seed";
  const ReportChart& pareto = charts[1];
  EXPECT_EQ(pareto.kind, Kind::POINTS);
  ASSERT_EQ(pareto.series.size(), 5u) << "a predictor each, and the front";
  ASSERT_TRUE(pareto.series[4].is_front);
  ASSERT_EQ(pareto.series[4].points.size(), 3u) << "autoregressive is slower than constant_velocity and leaves more";
  EXPECT_EQ(pareto.series[4].points[1].x, 2);
  EXPECT_EQ(pareto.series[4].points[2].y, 1);
}

TEST(SweepCharts, TooManySettingsArePooledAndItIsSaid) {
  StoredSweep sweep = test::synthetic_sweep();
  for (const char* key : {"motion.profile", "robot.type"}) sweep.plan.axes.push_back({key, {"a", "b", "c"}, false});
  sweep.results.clear();
  for (std::uint64_t i = 0; i < sweep.plan.runs(); ++i)
    sweep.results[i] = {i, "done", {1.0 + static_cast<double>(i), 0, 1}, 1, ""};
  const auto charts = sweep_charts(sweep.plan, sweep.results);
  EXPECT_EQ(charts[0].series.size(), 12u) << "predictors and profiles; the robots are pooled";
  EXPECT_NE(charts[0].note.find("All robot.type are pooled"), std::string::npos) << charts[0].note;
  for (const auto& chart : charts) EXPECT_LE(chart.series.size(), 15u) << chart.title;
}

TEST(SweepCharts, NothingDoneDrawsNothing) {
  StoredSweep sweep = test::synthetic_sweep();
  EXPECT_TRUE(sweep_charts(sweep.plan, {}).empty());
  for (auto& [run, r] : sweep.results) r.status = "failed";
  EXPECT_TRUE(sweep_charts(sweep.plan, sweep.results).empty());
}

TEST(SweepReport, IsMadeAgainFromTheFolder) {
  const StoredSweep sweep = test::synthetic_sweep();
  const test::TemporaryFolder folder;
  {
    SweepStore store(folder.path(), sweep.plan, 0);
    for (const auto& [run, r] : sweep.results) store.add(r);
    store.write_sorted();
  }
  const auto summary = sweep_summary(sweep.plan, sweep.results);
  test::write_text(folder / "results.json", summary.dump());
  ASSERT_TRUE(is_sweep(folder.path()));
  const StoredSweep again = read_swept(folder.path());
  EXPECT_EQ(sweep_summary(again.plan, again.results), summary);
  const Report report = sweep_report(again.plan, again.results, summary);
  EXPECT_EQ(report_html(report), report_html(sweep_report(sweep.plan, sweep.results, summary)));
  EXPECT_NE(report.headline.find("engines.predictor mixture, latency_ms 8"), std::string::npos) << report.headline;
  EXPECT_EQ(report.headline_number, "0.131") << "8 / 70 x 1.15";
  EXPECT_EQ(report_html(report).find("<against>"), std::string::npos);
  test::write_text(folder / "results.json", "{\"command\": \"servo\"}");
  EXPECT_NE(test::message_of<InputError>([&] { read_swept(folder.path()); }).find("not a sweep's"), std::string::npos);
  test::write_text(folder / "results.json", "{\"command\": \"sweep\", \"sweep\": \"a\", \"title\": \"\"}");
  EXPECT_NE(test::message_of<InputError>([&] { read_swept(folder.path()); }).find("lacks axes"), std::string::npos);
}

}  // namespace
}  // namespace heartservo::tools
