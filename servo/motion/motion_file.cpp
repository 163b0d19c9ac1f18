#include "servo/motion/motion_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>

#include "tracking/settings/csv_rows.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::servo {

namespace {

constexpr const char* kExpected = "a header with time_s and measured/x_m, measured/y_m, measured/z_m";
constexpr std::array<const char*, 3> kAxes{"/x_m", "/y_m", "/z_m"};

using Columns = std::array<std::size_t, 3>;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Names in front of /x_m, /y_m or /z_m, whole groups or not.
std::vector<std::string> groups_of(const CsvRows& rows) {
  std::vector<std::string> groups;
  for (const auto& name : rows.names())
    for (const std::string axis : kAxes)
      if (name.size() > axis.size() && name.ends_with(axis)) {
        const std::string group = name.substr(0, name.size() - axis.size());
        if (!contains(groups, group)) groups.push_back(group);
      }
  return groups;
}

std::size_t require(const CsvRows& rows, const std::string& name) {
  const auto column = rows.find(name);
  if (!column) {
    std::vector<std::string> others = rows.names();  // without those that are as they should be
    std::erase_if(others, [](const std::string& other) {
      return other == "time_s" || std::any_of(kAxes.begin(), kAxes.end(), [&](auto a) { return other.ends_with(a); });
    });
    rows.fail(fmt::format("column {} is missing{}; expected {}", name, did_you_mean(name, others), kExpected));
  }
  if (std::count(rows.names().begin(), rows.names().end(), name) > 1)
    rows.fail(fmt::format("column {} is there twice", name));
  return *column;
}

Columns columns_of(const CsvRows& rows, const std::string& group) {
  return {require(rows, group + "/x_m"), require(rows, group + "/y_m"), require(rows, group + "/z_m")};
}

std::string chosen_group(const CsvRows& rows, const std::string& file, const std::string& wanted) {
  const auto groups = groups_of(rows);
  if (!wanted.empty()) {
    if (contains(groups, wanted)) return wanted;
    throw ConfigError(fmt::format("{}: no columns '{}/x_m'{}; it has {}", file, wanted, did_you_mean(wanted, groups),
                                  groups.empty() ? "none of that kind" : fmt::format("{}", fmt::join(groups, ", "))));
  }
  if (contains(groups, "measured") || groups.empty()) return "measured";
  std::vector<std::string> others = groups;
  std::erase(others, "truth");
  if (others.empty()) return "truth";
  if (others.size() == 1) return others[0];
  throw ConfigError(fmt::format("{}: has several points: choose one with --points {}", file, fmt::join(others, "|")));
}

Eigen::Vector3d place(const CsvRows& rows, const Columns& columns) {
  const Eigen::Vector3d p(rows.number(columns[0]), rows.number(columns[1]), rows.number(columns[2]));
  if (p.array().isInf().any()) rows.fail("a position must be finite, or empty where it is not known");
  return p.allFinite() ? p : Eigen::Vector3d(Eigen::Vector3d::Constant(NAN));
}

// "" or what is wrong with `time` after the rows so far.
std::string wrong_time(double time, const MotionRecord& record) {
  if (!std::isfinite(time)) return "the time is missing or not finite";
  if (record.time_s.empty() || time > record.time_s.back()) return "";
  return fmt::format("time {} s comes after {} s in line {}; times must increase", time, record.time_s.back(),
                     record.line.back());
}

MotionRecord read_csv(const std::filesystem::path& file, const std::string& wanted) {
  CsvRows rows(file, kExpected);
  MotionRecord record;
  record.file = file.string();
  const std::size_t time = require(rows, "time_s");
  record.group = chosen_group(rows, record.file, wanted);
  const Columns columns = columns_of(rows, record.group);
  std::optional<Columns> truth;
  if (record.group == "measured" && rows.find("truth/x_m")) truth = columns_of(rows, "truth");
  while (rows.next()) {
    const double t = rows.number(time);
    if (const auto wrong = wrong_time(t, record); !wrong.empty()) rows.fail(wrong);
    record.position.push_back(place(rows, columns));
    if (truth) record.truth.push_back(place(rows, *truth));
    record.time_s.push_back(t);
    record.line.push_back(rows.line());
  }
  return record;
}

MotionRecord read_tum(const std::filesystem::path& file, const std::string& wanted) {
  if (!wanted.empty()) throw ConfigError(fmt::format("{}: --points is for CSV files", file.string()));
  std::ifstream in(file);
  if (!in || !std::filesystem::is_regular_file(file))
    throw InputError(fmt::format("{}: cannot be read; check the path and its permissions", file.string()));
  MotionRecord record;
  record.file = file.string();
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    if (line.find_first_not_of(" \t") == line.npos || line[0] == '#') continue;
    std::istringstream cells(line);
    std::array<double, 8> values{};
    std::size_t count = 0;
    bool good = true;
    for (std::string cell; cells >> cell; ++count) {
      double value = NAN;
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      good = good && error == std::errc{} && end == cell.data() + cell.size() && std::isfinite(value);
      if (count < 8) values[count] = value;
    }
    std::string wrong =
        good && count == 8 ? wrong_time(values[0], record) : "expected the numbers 'time x y z qx qy qz qw'";
    if (!wrong.empty()) throw InputError(fmt::format("{}:{}: {}", record.file, number, wrong));
    record.time_s.push_back(values[0]);
    record.position.emplace_back(values[1], values[2], values[3]);
    record.line.push_back(number);
  }
  return record;
}

}  // namespace

std::filesystem::path motion_file(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return path;
  if (std::filesystem::exists(path / "frames.csv")) return path / "frames.csv";
  throw InputError(
      fmt::format("{}: has no frames.csv; give a motion file, or a folder that 'heartservo track' or "
                  "'heartservo servo' left",
                  path.string()));
}

MotionRecord read_rows(const std::filesystem::path& file, const std::string& group) {
  return file.extension() == ".tum" ? read_tum(file, group) : read_csv(file, group);
}

std::vector<double> read_beats(const std::filesystem::path& file) {
  constexpr const char* kBeats = "a header with time_s, the times of the R peaks in s";
  CsvRows rows(file, kBeats);
  const auto column = rows.find("time_s");
  if (!column)
    rows.fail(fmt::format("column time_s is missing{}; expected {}", did_you_mean("time_s", rows.names()), kBeats));
  std::vector<double> beats;
  while (rows.next()) {
    const double t = rows.number(*column);
    if (!std::isfinite(t)) rows.fail("the time is missing or not finite");
    if (!beats.empty() && !(t > beats.back()))
      rows.fail(fmt::format("beat at {} s comes after {} s; times must increase", t, beats.back()));
    beats.push_back(t);
  }
  if (beats.empty()) throw InputError(file.string() + ": has a header and no beats");
  return beats;
}

}  // namespace heartservo::servo
