#pragma once
// CSV files row by row: a header of names, then rows of as many cells. Understands what spreadsheets write: \r\n, empty
// lines, blanks and quotes around a cell, a byte order mark. A comma inside quotes is not understood.
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace heartservo {

class CsvRows {
 public:
  /// Reads the file and its header. `expected` ends the sentence "is empty; expected ...". Throws InputError.
  CsvRows(const std::filesystem::path& file, const std::string& expected);
  CsvRows(const CsvRows&) = delete;
  CsvRows& operator=(const CsvRows&) = delete;

  const std::vector<std::string>& names() const { return names_; }
  std::optional<std::size_t> find(std::string_view name) const;

  /// Goes to the next row; false at the end. Throws InputError when the row is not as long as the header.
  bool next();

  /// Of the row, valid as long as this object; the header's number of them.
  const std::vector<std::string_view>& cells() const { return cells_; }
  /// NaN for an empty cell. Throws InputError for what is no number.
  double number(std::size_t column) const;

  /// Of the row (or header), counted from 1.
  int line() const { return line_; }

  /// No more rows than this are left to come.
  std::size_t rows_ahead() const;

  /// Throws InputError: "FILE:LINE: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  bool next_line();

  std::string file_, text_;
  std::string_view rest_;
  int line_ = 0;
  std::vector<std::string> names_;
  std::vector<std::string_view> cells_;
};

}  // namespace heartservo
