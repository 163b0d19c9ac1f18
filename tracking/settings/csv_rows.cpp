#include "tracking/settings/csv_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <limits>

#include "tracking/settings/errors.hpp"

namespace heartservo {

namespace {

std::string_view trimmed(std::string_view text) {
  const auto from = text.find_first_not_of(" \t\"");
  return from == text.npos ? "" : text.substr(from, text.find_last_not_of(" \t\"") - from + 1);
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(file))
    throw InputError(fmt::format("{}: cannot be read; check the path and its permissions", file.string()));
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

CsvRows::CsvRows(const std::filesystem::path& file, const std::string& expected)
    : file_(file.string()), text_(read_text(file)), rest_(text_) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  if (!next_line()) fail("is empty; expected " + expected);
  names_.assign(cells_.begin(), cells_.end());
}

std::optional<std::size_t> CsvRows::find(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names_.begin());
}

bool CsvRows::next_line() {
  while (!rest_.empty()) {
    const auto end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++line_;
    if (line.empty()) continue;
    cells_.clear();
    for (std::size_t comma; (comma = line.find(',')) != line.npos; line.remove_prefix(comma + 1))
      cells_.push_back(trimmed(line.substr(0, comma)));
    cells_.push_back(trimmed(line));
    return true;
  }
  return false;
}

bool CsvRows::next() {
  if (!next_line()) return false;
  if (cells_.size() != names_.size()) fail(fmt::format("{} cells under {} columns", cells_.size(), names_.size()));
  return true;
}

double CsvRows::number(std::size_t column) const {
  const std::string_view cell = cells_[column];
  double value = std::numeric_limits<double>::quiet_NaN();
  const auto [rest, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (!cell.empty() && (error != std::errc{} || rest != cell.data() + cell.size()))
    fail(fmt::format("'{}' under {} is not a number", cell, names_[column]));
  return value;
}

std::size_t CsvRows::rows_ahead() const {
  return static_cast<std::size_t>(std::count(rest_.begin(), rest_.end(), '\n')) + 1;
}

void CsvRows::fail(const std::string& what) const {
  throw InputError(fmt::format("{}:{}: {}", file_, std::max(line_, 1), what));
}

}  // namespace heartservo
