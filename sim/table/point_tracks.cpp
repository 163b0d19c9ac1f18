#include "sim/table/point_tracks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "tracking/settings/csv_rows.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::sim {

namespace {

constexpr const char* kExpected = "a header with frame or time_s, u_px, v_px, and optionally point, visible";

struct Columns {
  std::size_t when, u, v;
  std::optional<std::size_t> point, visible;
  bool by_frame;
};

Columns columns_of(const CsvRows& rows) {
  const auto frame = rows.find("frame"), time = rows.find("time_s"), u = rows.find("u_px"), v = rows.find("v_px");
  if (frame.has_value() == time.has_value() || !u || !v) rows.fail(std::string("expected ") + kExpected);
  const Columns columns{frame ? *frame : *time, *u, *v, rows.find("point"), rows.find("visible"), frame.has_value()};
  // 'visable' must not count as one of the columns that mean nothing
  for (const auto& name : rows.names())
    for (const char* known : {"point", "visible"})
      if (!rows.find(known))
        if (const std::string hint = did_you_mean(name, {known}); !hint.empty())
          rows.fail(fmt::format("column '{}' is not known{}", name, hint));
  return columns;
}

// NaN unless the row says that the point is visible and where.
Eigen::Vector2d place_of(const CsvRows& rows, const Columns& columns) {
  const Eigen::Vector2d px(rows.number(columns.u), rows.number(columns.v));
  if (std::isnan(px.x()) != std::isnan(px.y()) || px.array().isInf().any())
    rows.fail("u_px and v_px must both be pixel coordinates, or both be empty");
  if (!columns.visible) return px;
  const double visible = rows.number(*columns.visible);
  if (visible != 0 && visible != 1) rows.fail("visible must be 0 or 1");
  return visible == 1 ? px : Eigen::Vector2d(Eigen::Vector2d::Constant(NAN));
}

bool contains(const tracking::Quad& region, const Eigen::Vector2d& p) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d side = region[(i + 1) % 4] - region[i], to = p - region[i];
    if (!(side.x() * to.y() - side.y() * to.x() >= 0)) return false;
  }
  return true;
}

}  // namespace

Eigen::Vector2d PointTrack::at(std::uint64_t sequence, double time_s) const {
  constexpr double kSameTime_s = 1e-6;
  const double wanted = by_frame ? static_cast<double>(sequence + 1) : time_s;
  const auto above = std::lower_bound(when.begin(), when.end(), wanted - kSameTime_s);
  const Eigen::Vector2d nowhere = Eigen::Vector2d::Constant(NAN);
  if (above == when.end()) return nowhere;
  const auto i = static_cast<std::size_t>(above - when.begin());
  if (std::abs(*above - wanted) <= kSameTime_s) return px[i];
  if (i == 0 || by_frame) return nowhere;
  const double t = (wanted - when[i - 1]) / (when[i] - when[i - 1]);
  return (1 - t) * px[i - 1] + t * px[i];
}

PointTracks PointTracks::read(const std::string& file) {
  PointTracks tracks;
  tracks.file_ = file;
  CsvRows rows(file, kExpected);
  const Columns columns = columns_of(rows);
  while (rows.next()) {
    const std::string name(columns.point ? rows.cells()[*columns.point] : "");
    if (columns.point && name.empty()) rows.fail("the point has no name");
    const double when = rows.number(columns.when);
    if (!std::isfinite(when) || (columns.by_frame && (when < 1 || when != std::floor(when))))
      rows.fail(columns.by_frame ? "frame must be a whole number from 1" : "time_s must be a time");
    auto point = std::find_if(tracks.points_.begin(), tracks.points_.end(), [&](auto& p) { return p.name == name; });
    if (point == tracks.points_.end()) point = tracks.points_.insert(point, PointTrack{name, columns.by_frame, {}, {}});
    if (!point->when.empty() && !(when > point->when.back()))
      rows.fail(fmt::format("{}{} after {}; the rows of a point must go on in time",
                            columns.by_frame ? "frame " : "time ", when, point->when.back()));
    point->when.push_back(when);
    point->px.push_back(place_of(rows, columns));
  }
  if (tracks.points_.empty()) throw InputError(file + ": has a header and no rows");
  return tracks;
}

const PointTrack& PointTracks::choose(const std::string& name, const tracking::Quad& region) const {
  const bool unnamed = points_.size() == 1 && points_[0].name.empty();
  const PointTrack* best = nullptr;
  double best_px = INFINITY;
  std::vector<std::string> names;
  for (const auto& point : points_) {
    names.push_back(point.name);
    const Eigen::Vector2d start = point.at(0, 0);
    if (!name.empty() && point.name == name) {
      if (!start.allFinite())
        throw ConfigError(fmt::format("{}: point '{}' is not visible in the first frame", file_, name));
      if (!contains(region, start))
        throw ConfigError(
            fmt::format("{}: point '{}' lies at ({:.1f}, {:.1f}) in the first frame, outside the region; choose "
                        "another point or region",
                        file_, name, start.x(), start.y()));
      return point;
    }
    const double px = (start - tracking::centre(region)).norm();
    if (contains(region, start) && px < best_px) best = &point, best_px = px;
  }
  if (!name.empty())
    throw ConfigError(unnamed ? fmt::format("{}: its point has no name; leave '{}' out", file_, name)
                              : fmt::format("{}: no point '{}'{}; it has {}", file_, name, did_you_mean(name, names),
                                            fmt::join(names, ", ")));
  if (unnamed && !points_[0].at(0, 0).allFinite()) return points_[0];
  if (best == nullptr)
    throw ConfigError(file_ + ": no point is inside the region in the first frame; choose another region");
  return *best;
}

}  // namespace heartservo::sim
