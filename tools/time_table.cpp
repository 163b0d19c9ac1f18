#include "tools/time_table.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "tracking/settings/csv_rows.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::tools {

namespace {

[[noreturn]] void reject(const std::string& what) { throw std::invalid_argument("TimeTable: " + what); }

std::string_view trimmed(std::string_view text) {
  const auto from = text.find_first_not_of(" \t");
  return from == text.npos ? "" : text.substr(from, text.find_last_not_of(" \t") - from + 1);
}

}  // namespace

TimeTable::TimeTable(std::vector<std::string> columns, std::size_t rows)
    : names_(std::move(columns)), values_(names_.size()) {
  if (names_.empty() || (names_[0] != "time_s" && names_[0] != "frequency_hz"))
    reject("the first column must be time_s");
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const std::string& name = names_[i];
    const bool printable = std::all_of(name.begin(), name.end(), [](unsigned char c) { return c >= ' ' && c != 127; });
    if (name.empty() || !printable || name.find_first_of(",\"") != name.npos || trimmed(name) != name)
      reject(fmt::format("column {} is named '{}'; a name must be printable, without comma and quote", i + 1, name));
    if (std::find(names_.begin(), names_.begin() + i, name) != names_.begin() + i)
      reject(fmt::format("column '{}' is there twice", name));
  }
  reserve(rows);
}

void TimeTable::reserve(std::size_t rows) {
  for (auto& values : values_) values.reserve(rows);
}

void TimeTable::append(std::span<const double> row) {
  if (row.size() != names_.size())
    reject(fmt::format("append() got {} values for {} columns", row.size(), names_.size()));
  if (!std::isfinite(row[0]) || (rows() > 0 && row[0] <= time_s().back()))
    reject(fmt::format("append() got time {} s after {} s; times must be finite and increase", row[0],
                       rows() > 0 ? time_s().back() : -std::numeric_limits<double>::infinity()));
  for (std::size_t i = 0; i < row.size(); ++i) values_[i].push_back(row[i]);
}

bool TimeTable::has(std::string_view column) const {
  return std::find(names_.begin(), names_.end(), column) != names_.end();
}

std::span<const double> TimeTable::column(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) reject(fmt::format("no column '{}'{}", name, did_you_mean(std::string(name), names_)));
  return values_[static_cast<std::size_t>(found - names_.begin())];
}

void TimeTable::write_csv(const std::filesystem::path& file) const {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{}\n", fmt::join(names_, ","));
  for (std::size_t row = 0; row < rows(); ++row)
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (!std::isnan(values_[i][row])) fmt::format_to(out, FMT_COMPILE("{}"), values_[i][row]);
      text.push_back(i + 1 < values_.size() ? ',' : '\n');
    }
  std::ofstream stream(file, std::ios::binary);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  if (!stream) throw ConfigError(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
}

TimeTable TimeTable::read_csv(const std::filesystem::path& file) {
  CsvRows rows(file, "a header that begins with time_s");
  try {
    TimeTable table(rows.names(), rows.rows_ahead());
    std::vector<double> row(table.names_.size());
    while (rows.next()) {
      for (std::size_t i = 0; i < row.size(); ++i) row[i] = rows.number(i);
      table.append(row);
    }
    return table;
  } catch (const std::invalid_argument& e) {
    rows.fail(e.what());
  }
}

}  // namespace heartservo::tools
