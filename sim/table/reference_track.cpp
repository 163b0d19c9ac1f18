#include "sim/table/reference_track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "tracking/settings/errors.hpp"

namespace heartservo::sim {

namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',')
      cells.emplace_back();
    else if (c != '\r' && c != ' ')
      cells.back() += c;
  }
  return cells;
}

}  // namespace

ReferenceTrack ReferenceTrack::read(const std::string& file) {
  ReferenceTrack track;
  track.file_ = file;
  std::ifstream in(file);
  if (!in) throw InputError(file + ": cannot be read; check the path");
  std::string line;
  std::getline(in, line);
  if (cells_of(line) != std::vector<std::string>{"time_s", "u_px", "v_px"})
    throw InputError(file + ":1: the header must be time_s,u_px,v_px");
  for (int number = 2; std::getline(in, line); ++number) {
    if (line.empty()) continue;
    const auto cells = cells_of(line);
    double values[3] = {NAN, NAN, NAN};
    bool good = cells.size() == 3;
    for (std::size_t i = 0; good && i < 3; ++i) {
      if (i > 0 && cells[i].empty()) continue;  // not visible in this frame
      const char* end = cells[i].data() + cells[i].size();
      const auto [stop, error] = std::from_chars(cells[i].data(), end, values[i]);
      good = error == std::errc() && stop == end;
    }
    if (!good || !std::isfinite(values[0]) || (!track.time_s_.empty() && !(values[0] > track.time_s_.back())))
      throw InputError(
          fmt::format("{}:{}: expected a later time and two pixel coordinates, or empty cells", file, number));
    track.time_s_.push_back(values[0]);
    track.points_.emplace_back(values[1], values[2]);
  }
  if (track.time_s_.empty()) throw InputError(file + ": holds no rows");
  return track;
}

Eigen::Vector2d ReferenceTrack::at(double time_s) const {
  constexpr double kSameTime_s = 1e-6;
  const auto above = std::lower_bound(time_s_.begin(), time_s_.end(), time_s - kSameTime_s);
  if (above == time_s_.end()) return Eigen::Vector2d::Constant(NAN);
  const auto i = static_cast<std::size_t>(above - time_s_.begin());
  if (std::abs(*above - time_s) <= kSameTime_s) return points_[i];
  if (i == 0) return Eigen::Vector2d::Constant(NAN);
  const double t = (time_s - time_s_[i - 1]) / (time_s_[i] - time_s_[i - 1]);
  return (1 - t) * points_[i - 1] + t * points_[i];
}

}  // namespace heartservo::sim
