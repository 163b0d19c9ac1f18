#pragma once
// Numbers over time, a row a frame: what frames.csv holds. Columns have names with '/' for grouping and the unit at the
// end (`residual/x_m`), so that the file opens in PlotJuggler as it is. NaN means "no value" and is an empty cell.
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace heartservo::tools {

class TimeTable {
 public:
  /// `columns[0]` must be "time_s", or "frequency_hz" for a spectrum, which the rest of this calls time. Throws std::invalid_argument for that, for an empty, repeated or unprintable name,
  /// or one with a comma or quote. append() allocates nothing for the first `rows` rows.
  explicit TimeTable(std::vector<std::string> columns, std::size_t rows = 0);

  void reserve(std::size_t rows);

  /// One value per column. Throws std::invalid_argument when their number is wrong or the time (the first value) is not
  /// finite and later than that of the row before.
  void append(std::span<const double> row);
  void append(std::initializer_list<double> row) { append(std::span<const double>(row.begin(), row.size())); }

  std::size_t rows() const { return values_.front().size(); }
  const std::vector<std::string>& columns() const { return names_; }
  bool has(std::string_view column) const;
  /// The values of a column, valid until the next append(). Throws std::invalid_argument for an unknown name, with a
  /// suggestion.
  std::span<const double> column(std::string_view name) const;
  std::span<const double> time_s() const { return values_.front(); }

  /// CSV with shortest numbers that read back as the same double. Throws ConfigError when the file cannot be written.
  void write_csv(const std::filesystem::path& file) const;
  /// Reads what write_csv() wrote, or any CSV with a header whose first column is time_s. Throws InputError with file
  /// and line.
  static TimeTable read_csv(const std::filesystem::path& file);

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<double>> values_;  // a vector a column
};

}  // namespace heartservo::tools
