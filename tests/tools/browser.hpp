#pragma once
// A report in headless Chromium, where there is one.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/temporary_folder.hpp"
#include "tools/report/report.hpp"

namespace heartservo::test {

class ReportInBrowser : public testing::Test {
 protected:
  void SetUp() override {
#ifdef HEARTSERVO_SANITIZED
    GTEST_SKIP() << "the browser sees the same page as without sanitizers";
#endif
    if (std::system("command -v chromium >/dev/null 2>&1") != 0)
      GTEST_SKIP() << "chromium is not installed; ./run_tests.sh installs it";
  }

  // The page after its scripts and then `script` have run. `log_` has what the browser said meanwhile.
  std::string opened(const tools::Report& report, const std::string& script = "",
                     const std::string& options = "--window-size=1280,900") {
    const auto path = [&](const char* name) { return (folder_ / name).string(); };
    write_text(path("report.html"), tools::report_html(report) + "<script>" + script + "</script>");
    const std::string command =
        "timeout 100 chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage"
        " --disable-background-networking --disable-sync --no-first-run --enable-logging=stderr --v=0"
        " --host-resolver-rules='MAP * ~NOTFOUND' " +
        options +
        " --virtual-time-budget=4000"
        " --user-data-dir=" +
        path("profile") + " --dump-dom file://" + path("report.html") + " >" + path("dom.html") + " 2>" + path("log");
    EXPECT_EQ(std::system(command.c_str()), 0);
    log_ = read_text(path("log"));
    return read_text(path("dom.html"));
  }

  const TemporaryFolder folder_;
  std::string log_;
};

inline std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

}  // namespace heartservo::test
