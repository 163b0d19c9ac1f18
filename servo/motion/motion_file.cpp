#include "servo/motion/motion_file.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "tracking/settings/errors.hpp"

namespace heartservo::servo {

namespace {

using Pose = std::array<double, 8>;

std::optional<Pose> pose_of(const std::string& line) {
  std::istringstream cells(line);
  Pose pose{};
  std::size_t count = 0;
  for (std::string cell; cells >> cell; ++count) {
    if (count == pose.size()) return std::nullopt;
    double& value = pose[count];
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
  }
  return count == pose.size() ? std::optional(pose) : std::nullopt;
}

}  // namespace

std::string motion_file(const std::string& path) {
  if (!std::filesystem::is_directory(path)) return path;
  const auto file = std::filesystem::path(path) / "frames.csv";
  if (std::filesystem::exists(file)) return file.string();
  throw InputError(path +
                   ": has no frames.csv; give a motion file, or a folder that 'heartservo track' or 'heartservo "
                   "servo' left");
}

MotionRecord read_tum(const std::string& file) {
  std::ifstream in(file);
  if (!in || !std::filesystem::is_regular_file(file))
    throw InputError(file + ": cannot be read; check the path and its permissions");
  MotionRecord record;
  record.file = file;
  int number = 0;
  const auto fail = [&](const std::string& what) { throw InputError(fmt::format("{}:{}: {}", file, number, what)); };
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    if (line.find_first_not_of(" \t") == line.npos || line[0] == '#') continue;
    const auto pose = pose_of(line);
    if (!pose) fail("expected the numbers 'time x y z qx qy qz qw'");
    if (!record.time_s.empty() && !((*pose)[0] > record.time_s.back()))
      fail(fmt::format("time {} s after {} s; time must go on", (*pose)[0], record.time_s.back()));
    record.time_s.push_back((*pose)[0]);
    record.measured.emplace_back((*pose)[1], (*pose)[2], (*pose)[3]);
    record.line.push_back(number);
  }
  return record;
}

}  // namespace heartservo::servo
