#include "servo/motion/motion_record.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "servo/motion/motion_file.hpp"
#include "tracking/settings/csv_rows.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::servo {

namespace {

constexpr const char* kExpected = "a header with time_s and measured/x_m, measured/y_m, measured/z_m";
constexpr std::array<const char*, 3> kAxes{"/x_m", "/y_m", "/z_m"};
using Columns = std::array<std::size_t, 3>;

// Names before "/x_m" and the like, in the file's order.
std::vector<std::string> groups_of(const CsvRows& rows) {
  std::vector<std::string> groups;
  for (const std::string& name : rows.names())
    for (const char* axis : kAxes)
      if (name.ends_with(axis)) {
        const std::string group = name.substr(0, name.size() - 4);
        if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
      }
  return groups;
}

Columns columns_of(const CsvRows& rows, const std::string& group) {
  Columns columns{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto found = rows.find(group + kAxes[i]);
    if (!found) {
      const std::string name = group + kAxes[i];
      std::vector<std::string> others = rows.names();  // without those that are right
      std::erase_if(others, [&](const std::string& other) {
        return std::any_of(kAxes.begin(), kAxes.end(), [&](const char* axis) { return other == group + axis; });
      });
      rows.fail(fmt::format("there is no column {}{}; expected {}", name, did_you_mean(name, others), kExpected));
    }
    if (std::count(rows.names().begin(), rows.names().end(), group + kAxes[i]) > 1)
      rows.fail(fmt::format("column {} is there twice", group + kAxes[i]));
    columns[i] = *found;
  }
  return columns;
}

std::string chosen_group(const CsvRows& rows, const std::string& file, const std::string& wanted) {
  std::vector<std::string> groups = groups_of(rows);
  if (groups.size() > 1 && wanted != "truth") std::erase(groups, "truth");
  if (groups.empty()) {
    std::string hint;
    for (const std::string& name : rows.names())
      if (hint.empty()) hint = did_you_mean(name, {"measured/x_m", "measured/y_m", "measured/z_m"});
    rows.fail(fmt::format("no column has a position{}; expected {}", hint, kExpected));
  }
  if (!wanted.empty()) {
    if (std::find(groups.begin(), groups.end(), wanted) == groups.end())
      throw ConfigError(fmt::format("{}: there are no points '{}'{}; choose one of {}", file, wanted,
                                    did_you_mean(wanted, groups), fmt::join(groups, ", ")));
    return wanted;
  }
  if (std::find(groups.begin(), groups.end(), "measured") != groups.end()) return "measured";
  if (groups.size() > 1)
    throw ConfigError(
        fmt::format("{}: there are several points; choose one with --points: {}", file, fmt::join(groups, ", ")));
  return groups.front();
}

std::size_t time_column(const CsvRows& rows) {
  if (const auto time = rows.find("time_s")) return *time;
  std::string hint;
  for (const std::string& name : rows.names())
    if (hint.empty() && !did_you_mean(name, {"time_s"}).empty()) hint = fmt::format("; '{}' is not it", name);
  rows.fail(fmt::format("there is no column time_s{}; expected {}", hint, kExpected));
}

double next_time(const CsvRows& rows, std::size_t column, const std::vector<double>& before) {
  const double time = rows.number(column);
  if (!std::isfinite(time)) rows.fail("time_s must be a time");
  if (!before.empty() && !(time > before.back()))
    rows.fail(fmt::format("time {} s after {} s; time must go on", time, before.back()));
  return time;
}

Eigen::Vector3d position(const CsvRows& rows, const Columns& columns) {
  Eigen::Vector3d p;
  for (int i = 0; i < 3; ++i) p[i] = rows.number(columns[static_cast<std::size_t>(i)]);
  if (p.array().isInf().any()) rows.fail("a position is infinite");
  if (p.hasNaN() && !p.array().isNaN().all()) rows.fail("only part of a position is there; give all three or none");
  return p;
}

void look_for_oddities(MotionRecord& record) {
  const double period = record.period_s();
  std::size_t gaps = 0, empty = 0, first_gap = 0, first_empty = 0;
  Eigen::Array3d low = Eigen::Array3d::Constant(INFINITY), high = -low;
  for (std::size_t i = 0; i < record.time_s.size(); ++i) {
    if (i > 0 && record.time_s[i] - record.time_s[i - 1] > 1.5 * period && gaps++ == 0) first_gap = i;
    if (record.measured[i].hasNaN()) {
      if (empty++ == 0) first_empty = i;
      continue;
    }
    low = low.min(record.measured[i].array());
    high = high.max(record.measured[i].array());
  }
  const auto warn = [&](std::size_t row, const std::string& what) {
    record.warnings.push_back(fmt::format("{}:{}: {}", record.file, record.line[row], what));
  };
  if (empty == record.time_s.size())
    throw InputError(fmt::format("{}:{}: no row has a position under {}/x_m, {}/y_m, {}/z_m", record.file,
                                 record.line.front(), record.group, record.group, record.group));
  if (gaps > 0)
    warn(first_gap, fmt::format("{:.6g} s without a row{}", record.time_s[first_gap] - record.time_s[first_gap - 1],
                                gaps > 1 ? fmt::format(", and {} more gaps", gaps - 1) : ""));
  if (empty > 0)
    warn(first_empty, fmt::format("no position{}", empty > 1 ? fmt::format(", as in {} more rows", empty - 1) : ""));
  for (int i = 0; i < 3; ++i)
    if (low[i] == high[i]) warn(0, fmt::format("{} is {} in every row", "xyz"[i], low[i]));
}

}  // namespace

double MotionRecord::period_s() const {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time_s.size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

namespace {

MotionRecord read_csv(const std::string& file, const std::string& group) {
  CsvRows rows(file, kExpected);
  MotionRecord record;
  record.file = file;
  const std::size_t time = time_column(rows);
  record.group = chosen_group(rows, file, group);
  const Columns measured = columns_of(rows, record.group);
  const auto groups = groups_of(rows);
  std::optional<Columns> truth;
  if (record.group == "measured" && std::find(groups.begin(), groups.end(), "truth") != groups.end())
    truth = columns_of(rows, "truth");
  while (rows.next()) {
    record.time_s.push_back(next_time(rows, time, record.time_s));
    record.measured.push_back(position(rows, measured));
    if (truth) record.truth.push_back(position(rows, *truth));
    record.line.push_back(rows.line());
  }
  return record;
}

}  // namespace

MotionRecord read_motion_record(const std::string& path, const std::string& group) {
  const std::string file = motion_file(path);
  const bool tum = file.ends_with(".tum");
  if (tum && !group.empty()) throw ConfigError(file + ": a trajectory has one point; --points is for CSV files");
  MotionRecord record = tum ? read_tum(file) : read_csv(file, group);
  if (record.time_s.size() < 2)
    throw InputError(fmt::format("{}{}: {} row{} of positions; a motion needs two at least", file,
                                 record.line.empty() ? "" : fmt::format(":{}", record.line[0]), record.time_s.size(),
                                 record.time_s.size() == 1 ? "" : "s"));
  look_for_oddities(record);
  return record;
}

std::vector<double> read_beats(const std::string& file) {
  CsvRows rows(file, "a header with time_s, then the time of an R peak a row");
  const auto column = rows.find("time_s");
  if (!column) rows.fail("there is no column time_s; expected the time of an R peak a row");
  std::vector<double> beats;
  while (rows.next()) beats.push_back(next_time(rows, *column, beats));
  if (beats.empty()) rows.fail("no beats; expected the time of an R peak a row");
  return beats;
}

}  // namespace heartservo::servo
