#include "tracking/camera/calibration/coverage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace heartservo::tracking {

namespace {

constexpr int PICTURE_CELLS = 10;  // along the longer side

double share_with_points(std::vector<int>::const_iterator from, std::vector<int>::const_iterator to) {
  const auto with = std::count_if(from, to, [](int n) { return n > 0; });
  return static_cast<double>(with) / static_cast<double>(to - from);
}

}  // namespace

double PictureCoverage::share() const { return share_with_points(points.begin(), points.end()); }

std::vector<std::string> PictureCoverage::missing_parts() const {
  static const char* const vertical[] = {"top", "", "bottom"};
  static const char* const horizontal[] = {"left", "", "right"};
  std::vector<std::string> missing;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      int cells = 0, seen = 0;
      for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
          if (3 * row / rows != j || 3 * column / columns != i) continue;
          ++cells;
          seen += at(column, row) > 0;
        }
      if (2 * seen >= cells) continue;
      const std::string name =
          fmt::format("{}{}{}", vertical[j], *vertical[j] && *horizontal[i] ? " " : "", horizontal[i]);
      missing.push_back(name.empty() ? "centre" : name);
    }
  return missing;
}

PictureCoverage picture_coverage(int width, int height, const std::vector<Corners>& views) {
  PictureCoverage c;
  const double cell = static_cast<double>(std::max(width, height)) / PICTURE_CELLS;
  c.columns = std::max(3, static_cast<int>(std::lround(width / cell)));
  c.rows = std::max(3, static_cast<int>(std::lround(height / cell)));
  c.points.assign(static_cast<std::size_t>(c.columns * c.rows), 0);
  for (const auto& view : views)
    for (const auto& pixel : view) {
      const int column = static_cast<int>(std::floor((pixel.x() + 0.5) / width * c.columns));
      const int row = static_cast<int>(std::floor((pixel.y() + 0.5) / height * c.rows));
      if (column < 0 || row < 0 || column >= c.columns || row >= c.rows) continue;
      ++c.points[static_cast<std::size_t>(row * c.columns + column)];
    }
  return c;
}

std::string WorkingVolume::description() const {
  return fmt::format("{:.4g} x {:.4g} x {:.4g} mm at {:.4g} mm", 1e3 * size_m.x(), 1e3 * size_m.y(), 1e3 * size_m.z(),
                     1e3 * distance_m);
}

double VolumeCoverage::share() const { return share_with_points(points.begin(), points.end()); }

double VolumeCoverage::share_of_slice(int z) const {
  const auto slice = static_cast<std::ptrdiff_t>(cells.x()) * cells.y();
  return share_with_points(points.begin() + z * slice, points.begin() + (z + 1) * slice);
}

VolumeCoverage volume_coverage(const WorkingVolume& volume, const std::vector<Eigen::Vector3d>& points) {
  VolumeCoverage c;
  for (int k = 0; k < 3; ++k)
    c.cells[k] = std::clamp(static_cast<int>(std::lround(volume.size_m[k] / volume.cell_m)), 1, 100);
  c.points.assign(static_cast<std::size_t>(c.cells.prod()), 0);
  const Eigen::Vector3d start = Eigen::Vector3d(0, 0, volume.distance_m) - volume.size_m / 2;
  for (const auto& point : points) {
    const Eigen::Array3d place = (point - start).array() / volume.size_m.array() * c.cells.cast<double>().array();
    const Eigen::Array3i cell = place.floor().cast<int>();
    if ((cell < 0).any() || (cell >= c.cells.array()).any()) continue;
    ++c.points[static_cast<std::size_t>((cell.z() * c.cells.y() + cell.y()) * c.cells.x() + cell.x())];
  }
  return c;
}

}  // namespace heartservo::tracking
