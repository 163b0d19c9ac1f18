// The page of a sweep in headless Chromium: every chart is drawn, in the light and in the dark, on a desktop and on a
// phone.
#include <fmt/format.h>

#include "tests/tools/browser.hpp"
#include "tests/tools/sweep/synthetic_sweep.hpp"

namespace heartservo::tools {
namespace {

using test::count;

class SweepInBrowser : public test::ReportInBrowser {
 protected:
  Report report() const {
    const StoredSweep s = test::synthetic_sweep();
    return sweep_report(s.plan, s.results, sweep_summary(s.plan, s.results));
  }
  // The numbers that the page's script put into its title, after "seen".
  static std::vector<int> seen(const std::string& dom) {
    std::vector<int> numbers;
    const auto at = dom.find("<title>seen ");
    if (at == std::string::npos) return numbers;
    for (const char* text = dom.c_str() + at + 11; *text == ' ' || *text == ',';) {
      char* end = nullptr;
      numbers.push_back(static_cast<int>(std::strtol(text + 1, &end, 10)));
      text = end;
    }
    return numbers;
  }
  // For every chart: pixels of the first series' colour (outlines and marks), then whether the page is too wide.
  static std::string looks() {
    return "const want = getComputedStyle(document.documentElement).getPropertyValue('--s0').trim().slice(1)"
           ".match(/../g).map(h => parseInt(h, 16));"
           "const numbers = [...document.querySelectorAll('.chart canvas')].map(c => {"
           "const p = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0;"
           "for (let i = 0; i < p.length; i += 4) n += p[i + 3] > 200 && want.every((w, k) => Math.abs(p[i + k] - w) < "
           "3);"
           "return n; });"
           "numbers.push(document.documentElement.scrollWidth - innerWidth);"
           "document.title = 'seen ' + numbers.join(',');";
  }
  void expect_drawn(const std::string& options) {
    const std::string dom = opened(report(), looks(), options);
    EXPECT_EQ(log_.find("CONSOLE"), std::string::npos) << log_;
    EXPECT_NE(dom.find("data-charts=\"3\""), std::string::npos) << "the script of the page did not reach its end";
    const auto numbers = seen(dom);
    ASSERT_EQ(numbers.size(), 4u) << options;
    EXPECT_GT(numbers[0], 300) << "a line with four marks and intervals";
    EXPECT_GT(numbers[1], 100) << "the outlines of boxes";
    EXPECT_GT(numbers[2], 100) << "four marks";
    EXPECT_LE(numbers[3], 0) << "the page is wider than the window";
  }
};

TEST_F(SweepInBrowser, DrawsEveryChart) {
  expect_drawn("--window-size=1280,900");
  const std::string dom = opened(report());
  EXPECT_NE(dom.find("residual.rms_mm against latency_ms. hold: latency_ms 8 0.92 ["), std::string::npos)
      << "what a screen reader says";
  EXPECT_EQ(count(dom, "<canvas id=\"chart"), 3u);
}

TEST_F(SweepInBrowser, AlsoInTheDarkAndOnAPhone) {
  expect_drawn("--window-size=1280,900 --blink-settings=preferredColorScheme=0");
  expect_drawn("--window-size=500,900");
}

TEST_F(SweepInBrowser, KeepsWhatIsHiddenWhenThePaperComes) {
  const std::string dom =
      opened(report(),
             "const g = Chart.getChart('chart0'); g.hide(1); dispatchEvent(new Event('beforeprint'));"
             "const paper = g.width; dispatchEvent(new Event('afterprint'));"
             "document.title = 'seen ' + [paper, +g.isDatasetVisible(0), +g.isDatasetVisible(1), "
             "+(g.width > 700)].join(',');");
  EXPECT_EQ(log_.find("CONSOLE"), std::string::npos) << log_;
  EXPECT_EQ(seen(dom), (std::vector<int>{680, 1, 0, 1}));
}

}  // namespace
}  // namespace heartservo::tools
