#include "tools/progress.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "tests/support/temporary_folder.hpp"

namespace heartservo::tools {
namespace {

TEST(ProgressLine, ShowsBarRateAndTimeLeft) {
  EXPECT_EQ(progress_line("servo", 475, 1900, 2.5, 80),
            "servo [#########.............................] 475/1900  190 frames/s  0:08 left");
  EXPECT_EQ(progress_line("servo", 2000, 1900, 10, 80),
            "servo [#####################################] 1900/1900  200 frames/s  0:00 left");
}

TEST(ProgressLine, FitsTheTerminal) {
  EXPECT_EQ(progress_line("servo", 475, 1900, 2.5, 60), "servo [####..............] 475/1900  190 frames/s  0:08 left");
  EXPECT_EQ(progress_line("servo", 475, 1900, 2.5, 45), "servo 475/1900  190 frames/s  0:08 left");
  for (std::size_t width = 0; width < 120; ++width)
    EXPECT_LE(progress_line("servo", 475, 1900, 2.5, width).size(), width);
}

TEST(ProgressLine, CountsWhereTheEndIsUnknown) {
  EXPECT_EQ(progress_line("capture", 90, 0, 3, 80), "capture 90  30 frames/s");
}

TEST(ProgressLine, TellsSlowFromLong) {
  EXPECT_EQ(progress_line("x", 1, 10000, 2, 50), "x [..........] 1/10000  0.5 frames/s  5:33:18 left");
  EXPECT_EQ(progress_line("x", 0, 10, 0, 30), "x [.....................] 0/10") << "no rate yet";
}

// A terminal that a test can read: what `use` prints to it.
template <class Use>
std::string on_terminal(Use&& use) {
  int outer = -1, inner = -1;
  winsize size{24, 60, 0, 0};
  if (::openpty(&outer, &inner, nullptr, nullptr, &size) != 0) return "no terminal";
  ::setenv("TERM", "xterm", 1);
  std::FILE* stream = ::fdopen(inner, "w");
  use(stream);
  std::fclose(stream);
  ::fcntl(outer, F_SETFL, O_NONBLOCK);
  std::string text;
  char part[4096];
  for (ssize_t size_read; (size_read = ::read(outer, part, sizeof part)) > 0;)
    text.append(part, static_cast<std::size_t>(size_read));
  ::close(outer);
  return text;
}

TEST(Progress, DrawsAndWipesItsLineOnATerminal) {
  const std::string text = on_terminal([](std::FILE* stream) {
    Progress progress("servo", 100, false, stream);
    progress.update(25);
  });
  EXPECT_EQ(text.find("\r\033[Kservo [#"), 0u) << text;
  EXPECT_NE(text.find(" 25/100"), std::string::npos) << text;
  EXPECT_EQ(text.substr(text.size() - 4), "\r\033[K") << "the line is wiped at the end";
  EXPECT_LE(text.size(), 4 + 59 + 4u) << "not wider than the terminal";
}

TEST(Progress, DrawsRarely) {
  const std::string text = on_terminal([](std::FILE* stream) {
    Progress progress("servo", 100000, false, stream);
    for (std::size_t i = 0; i < 30; ++i) progress.update(i);  // more would fill the terminal's buffer
  });
  const auto lines = std::count(text.begin(), text.end(), '\r');
  EXPECT_GE(lines, 2);
  EXPECT_LE(lines, 10) << "thirty frames in a moment are one or two drawings";
}

TEST(Progress, KeepsSilentWhenQuietFinishedOrNotOnATerminal) {
  EXPECT_EQ(on_terminal([](std::FILE* stream) { Progress("servo", 100, true, stream).update(5); }), "");
  EXPECT_EQ(on_terminal([](std::FILE* stream) {
              Progress progress("servo", 100, false, stream);
              progress.finish();
              progress.update(5);
            }),
            "");
  const test::TemporaryFolder folder;
  std::FILE* file = std::fopen((folder / "log").c_str(), "w");
  Progress("servo", 100, false, file).update(5);
  std::fclose(file);
  EXPECT_EQ(test::read_text(folder / "log"), "");
}

}  // namespace
}  // namespace heartservo::tools
