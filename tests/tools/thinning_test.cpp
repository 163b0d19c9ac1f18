#include "tools/report/thinning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/tools/synthetic_report.hpp"
#include "tools/report/plot_data.hpp"

namespace heartservo::tools {
namespace {

TimeTable long_run(std::size_t rows) {
  TimeTable table({"time_s", "a", "b", "unused"}, rows);
  for (std::size_t i = 0; i < rows; ++i) {
    const double t = 0.008 * static_cast<double>(i);
    table.append({t, i == 70001 ? 99 : std::sin(t), i % 1000 == 0 ? NAN : std::cos(t), 1});
  }
  return table;
}

TEST(Thinning, ShortTablesStayAsTheyAre) {
  const TimeTable table = long_run(50);
  const TimeTable same = thinned(table, {"time_s", "a"}, 1000);
  EXPECT_EQ(same.columns(), (std::vector<std::string>{"time_s", "a"}));
  EXPECT_TRUE(std::ranges::equal(same.column("a"), table.column("a")));
}

TEST(Thinning, LongOnesKeepExtremesAndEnds) {
  const TimeTable table = long_run(200000);
  const TimeTable thin = thinned(table, {"time_s", "a", "b"}, 30000);
  EXPECT_LE(thin.rows(), 10001u);
  EXPECT_GT(thin.rows(), 1000u);
  EXPECT_EQ(*std::ranges::max_element(thin.column("a")), 99) << "one frame of 200000";
  EXPECT_EQ(thin.time_s().front(), 0);
  EXPECT_EQ(thin.time_s().back(), table.time_s().back());
  for (const double b : thin.column("b")) EXPECT_TRUE(std::isnan(b) || std::abs(b) <= 1);
}

TEST(Thinning, APageOfAMillionFramesStaysBelowTenMegabytes) {
  const TimeTable table = long_run(1000000);
  Report report;
  report.table = &table;
  report.plots = {{"Both", "mm", {{"a", "a"}, {"b", "b"}}, 1e3}};
  EXPECT_LT(report_html(report).size(), 10u << 20);
}

}  // namespace
}  // namespace heartservo::tools
