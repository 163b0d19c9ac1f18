#include "tools/time_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "tests/support/message.hpp"
#include "tests/support/random.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {
namespace {

using test::message_of;
using test::read_text;
using test::write_text;

constexpr double NONE = std::numeric_limits<double>::quiet_NaN();

template <class Action>
std::string rejection(Action&& action) {
  return message_of<std::invalid_argument>(action);
}

class TimeTableFile : public testing::Test {
 protected:
  std::string refusal(const std::string& text) {
    write_text(file_, text);
    const std::string message = message_of<InputError>([&] { TimeTable::read_csv(file_); });
    return message.substr(std::min(message.size(), file_.string().size()));  // without the file's name
  }

  test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "frames.csv";
};

TEST(TimeTable, GivesColumnsByName) {
  TimeTable table({"time_s", "heart/x_m", "heart/y_m"});
  table.append({0, 1, 2});
  table.append(std::vector<double>{0.5, 3, 4});
  EXPECT_EQ(table.rows(), 2u);
  EXPECT_TRUE(table.has("heart/x_m"));
  EXPECT_FALSE(table.has("heart/z_m"));
  EXPECT_EQ(table.time_s()[1], 0.5);
  EXPECT_EQ(table.column("heart/y_m")[1], 4);
  EXPECT_EQ(rejection([&] { table.column("hart/y_m"); }),
            "TimeTable: no column 'hart/y_m' (did you mean 'heart/y_m'?)");
}

TEST(TimeTable, AcceptsOnlyIncreasingTimes) {
  TimeTable table({"time_s", "x_m"});
  table.append({1, 0});
  for (const double time : {1.0, 0.5, NONE, std::numeric_limits<double>::infinity()})
    EXPECT_NE(rejection([&] { table.append({time, 0}); }), "nothing was thrown") << time;
  EXPECT_EQ(rejection([&] { table.append({2.0}); }), "TimeTable: append() got 1 values for 2 columns");
  EXPECT_EQ(table.rows(), 1u) << "a refused row leaves nothing behind";
}

TEST(TimeTable, RefusesNamesThatACsvCannotCarry) {
  const auto names = [](std::vector<std::string> columns) { return rejection([&] { TimeTable table(columns); }); };
  EXPECT_EQ(names({"x_m", "time_s"}), "TimeTable: the first column must be time_s");
  EXPECT_EQ(names({"time_s", "x_m", "x_m"}), "TimeTable: column 'x_m' is there twice");
  for (const char* bad : {"", "a,b", "a\"b", "a\nb", " a"})
    EXPECT_NE(names({"time_s", bad}), "nothing was thrown") << bad;
}

TEST(TimeTable, AppendsWithoutAllocatingWithinItsReserve) {
  TimeTable table({"time_s", "x_m"}, 100);
  table.append({0, 0});
  const double* before = table.column("x_m").data();
  for (int i = 1; i < 100; ++i) table.append({i * 0.01, 1});
  EXPECT_EQ(table.column("x_m").data(), before) << "the values have moved, so memory was asked for";
}

TEST_F(TimeTableFile, WritesShortNumbersAndEmptyCells) {
  TimeTable table({"time_s", "heart/x_m", "state"});
  table.append({0, 0.1, 0});
  table.append({0.0166, NONE, 2});
  table.append({1, -1e-9, NONE});
  table.write_csv(file_);
  EXPECT_EQ(read_text(file_), "time_s,heart/x_m,state\n0,0.1,0\n0.0166,,2\n1,-1e-09,\n");
}

TEST_F(TimeTableFile, ReadsBackTheSameDoubles) {
  auto random = test::seeded();
  TimeTable table({"time_s", "a", "b"}, 500);
  for (int i = 0; i < 500; ++i)
    table.append({i / 59.94, test::normal(random) * std::pow(10, test::uniform(random, -300, 300)),
                  i % 7 == 0 ? NONE : test::normal(random)});
  table.append({100, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::denorm_min()});
  table.write_csv(file_);
  const TimeTable back = TimeTable::read_csv(file_);
  ASSERT_EQ(back.columns(), table.columns());
  ASSERT_EQ(back.rows(), table.rows());
  for (const auto& name : table.columns())
    EXPECT_EQ(std::memcmp(back.column(name).data(), table.column(name).data(), table.rows() * sizeof(double)), 0)
        << name;
}

TEST_F(TimeTableFile, ReadsWhatSpreadsheetsWrite) {
  write_text(file_, "\xEF\xBB\xBFtime_s, x_m\r\n0, 1\r\n\r\n1 , \r\n2,3");
  const TimeTable table = TimeTable::read_csv(file_);
  ASSERT_EQ(table.rows(), 3u);
  EXPECT_EQ(table.column("x_m")[0], 1);
  EXPECT_TRUE(std::isnan(table.column("x_m")[1]));
  EXPECT_EQ(table.column("x_m")[2], 3);
}

TEST_F(TimeTableFile, NamesTheLineOfBadInput) {
  EXPECT_EQ(refusal(""), ":1: is empty; expected a header that begins with time_s");
  EXPECT_EQ(refusal("t,x\n0,1\n"), ":1: TimeTable: the first column must be time_s");
  EXPECT_EQ(refusal("time_s,x\n0,1\n1\n"), ":3: 1 cells under 2 columns");
  EXPECT_EQ(refusal("time_s,x\n0,1\n1,2 mm\n"), ":3: '2 mm' under x is not a number");
  EXPECT_EQ(refusal("time_s,x\n0,1\n\n0,2\n").substr(0, 4), ":4: ") << "times do not increase, empty lines count";
  EXPECT_EQ(refusal("time_s,x\n,1\n").substr(0, 4), ":2: ") << "a row without time";
}

TEST_F(TimeTableFile, NamesFilesThatCannotBeReadOrWritten) {
  const TimeTable table({"time_s"});
  EXPECT_EQ(
      message_of<ConfigError>([&] { table.write_csv("/nowhere/frames.csv"); }).find("/nowhere/frames.csv: cannot"), 0u);
  EXPECT_EQ(message_of<InputError>([&] { TimeTable::read_csv("/nowhere/frames.csv"); }).find("/nowhere/frames.csv: "),
            0u);
  EXPECT_NE(message_of<InputError>([&] { TimeTable::read_csv(folder_.path()); }), "nothing was thrown");
  EXPECT_NE(message_of<ConfigError>([&] { table.write_csv("/dev/full"); }), "nothing was thrown") << "no space left";
}

}  // namespace
}  // namespace heartservo::tools
