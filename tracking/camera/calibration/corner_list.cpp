#include "tracking/camera/calibration/corner_list.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

constexpr std::uintmax_t LARGEST_FILE = 4'000'000;  // bytes; a list of a million numbers is no board

void require_readable(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(file + ": no such file; check the path");
  if (!std::filesystem::is_regular_file(file, error)) throw InputError(file + ": is not a file; name corner lists");
  if (std::filesystem::file_size(file, error) > LARGEST_FILE)
    throw InputError(file + ": is too large for a corner list; expected 'u v' a line");
}

std::vector<std::string> words_of(std::string line) {
  line = line.substr(0, line.find('#'));
  for (char& c : line)
    if (c == ',' || c == ';') c = ' ';
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

bool has_number(const std::vector<std::string>& words) {
  for (const auto& word : words)
    if (word.find_first_of("0123456789") != std::string::npos) return true;
  return false;
}

}  // namespace

Corners read_corner_list(const std::string& file, const Board& board, int width, int height) {
  require_readable(file);
  std::ifstream in(file);
  if (!in) throw InputError(file + ": cannot be read; check its permissions");
  Corners corners;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.find('\0') != std::string::npos)
      throw InputError(file + ": is not a text file; expected 'u v' a line (pictures go without --corners)");
    const auto words = words_of(line);
    if (words.empty() || (corners.empty() && !has_number(words))) continue;
    const auto fail = [&](const std::string& what) { throw InputError(fmt::format("{}:{}: {}", file, number, what)); };
    if (words.size() != 2) fail(fmt::format("expected 'u v' in px, found {} words", words.size()));
    double value[2];
    for (int k = 0; k < 2; ++k) {
      char* end = nullptr;
      value[k] = std::strtod(words[static_cast<std::size_t>(k)].c_str(), &end);
      if (*end != '\0') fail(fmt::format("'{}' is not a number", words[static_cast<std::size_t>(k)]));
      if (!std::isfinite(value[k])) fail(fmt::format("holds {}; find the corners again", value[k]));
    }
    if (value[0] < -1 || value[1] < -1 || value[0] > width || value[1] > height)
      fail(fmt::format("corner ({}, {}) is outside the picture of {} x {} px; check --size", value[0], value[1], width,
                       height));
    corners.emplace_back(value[0], value[1]);
  }
  const std::string problem = grid_problem(board, corners);
  if (!problem.empty()) throw InputError(fmt::format("{}: {}", file, problem));
  return corners;
}

}  // namespace heartservo::tracking
