// Opens a report in headless Chromium, where there is one: the plots are drawn, nothing is complained about, nothing is
// asked of the network.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tools/browser.hpp"
#include "tests/tools/synthetic_report.hpp"

namespace heartservo::tools {
namespace {

using test::count;
using test::ReportInBrowser;

TEST_F(ReportInBrowser, DrawsEverythingWithoutComplaint) {
  const TimeTable table = test::synthetic_table(1900);
  const std::string dom = opened(test::synthetic_report(table));
  EXPECT_EQ(log_.find("CONSOLE"), std::string::npos) << log_;
  EXPECT_NE(dom.find("data-plots=\"5\""), std::string::npos) << "the script of the page did not reach its end";
  EXPECT_NE(dom.find("heart z: from "), std::string::npos) << "what a screen reader says";
  EXPECT_EQ(count(dom, "class=\"dygraph-rangesel-fgcanvas\""), 1u);
  EXPECT_GT(count(dom, "dygraph-axis-label"), 50u) << "five plots with two axes";
  EXPECT_NE(dom.find("</i>OK 96.9 %"), std::string::npos) << "how often the target was followed";
}

TEST_F(ReportInBrowser, ZoomsAllPlotsTogether) {
  const TimeTable table = test::synthetic_table(1900);
  const std::string press = "document.getElementById('plot1').dispatchEvent(new KeyboardEvent('keydown', {key: '";
  const std::string dom = opened(test::synthetic_report(table), press + "+'}));");
  EXPECT_EQ(log_.find("CONSOLE"), std::string::npos) << log_;
  EXPECT_NE(dom.find("<body class=\"zoomed\">"), std::string::npos);
  EXPECT_EQ(count(dom, ">0 s<"), 0u) << "a plot still begins where the run begins";
  EXPECT_EQ(count(dom, ">10 s<"), 5u);
  const std::string point =
      opened(test::synthetic_report(table),
             "const c = document.querySelectorAll('#plot2 canvas')[1], r = c.getBoundingClientRect();"
             "c.dispatchEvent(new MouseEvent('mousemove', {clientX: r.left + 300, clientY: r.top + "
             "50, bubbles: true}));");
  EXPECT_EQ(count(point, "class=\"at\">at "), 5u) << "all plots show their values at the same time";
  const std::string back = opened(test::synthetic_report(table), press + "+'}));" + press + "0'}));");
  EXPECT_EQ(back.find("<body class=\"zoomed\">"), std::string::npos);
  EXPECT_EQ(count(back, ">0 s<"), 5u) << "the whole run again";
}

TEST_F(ReportInBrowser, ShowsNineTrackersSideBySide) {
  const TimeTable table = test::synthetic_table(1900);
  Report report = test::synthetic_report(table);
  report.plots[0].series = {{"truth", "heart/z_m", true}};
  report.plots[3].log_from = 0.05;
  report.states.clear();
  for (int i = 0; i < 9; ++i) {
    const std::string name = fmt::format("tracker {}", i);
    report.plots[0].series.push_back({name, "tip/z_m"});
    report.states.push_back({name, "tracking/state"});
  }
  // how much of the last strip has the colour of lost frames (#d55e00), in hundredths
  const std::string dom =
      opened(report,
             "const c = document.getElementById('strip8'), p = c.getContext('2d').getImageData(0, 5, "
             "c.width, 1).data; let n = 0; for (let i = 0; i < p.length; i += 4) n += p[i] === 213 && "
             "p[i + 1] === 94; document.title = 'lost ' + Math.round(1000 * n / c.width);");
  EXPECT_EQ(log_.find("CONSOLE"), std::string::npos) << log_;
  EXPECT_NE(dom.find("data-plots=\"5\""), std::string::npos) << "the script of the page did not reach its end";
  EXPECT_EQ(count(dom, "</i>OK 96.9 %"), 9u);
  EXPECT_EQ(count(dom, "</i>tracker 8"), 1u) << "the legend";
  EXPECT_EQ(count(dom, "class=\"truth\""), 1u);
  EXPECT_GE(count(dom, "class=\"dashes\""), 2u) << "the colours of the eighth and ninth are those of others";
  const auto at = dom.find("<title>lost ");
  ASSERT_NE(at, std::string::npos);
  EXPECT_NEAR(std::stod(dom.substr(at + 12)), 20, 10) << "39 of 1900 frames, in thousandths of the width";
}

TEST_F(ReportInBrowser, CopesWithNoPlotsAndNoFrames) {
  Report bare;
  bare.title = "nothing";
  opened(bare);
  EXPECT_EQ(log_.find("CONSOLE"), std::string::npos) << log_;
  const TimeTable empty = test::synthetic_table(0), one = test::synthetic_table(1);
  const std::string dom = opened(test::synthetic_report(empty));
  EXPECT_EQ(log_.find("CONSOLE"), std::string::npos) << log_;
  EXPECT_NE(dom.find(">No frames.<"), std::string::npos);
  opened(test::synthetic_report(one));
  EXPECT_EQ(log_.find("CONSOLE"), std::string::npos) << log_;
}

}  // namespace
}  // namespace heartservo::tools
