#include "tools/loop_table.hpp"

#include <array>
#include <cmath>

#include "servo/loop/loop_record.hpp"
#include "servo/loop/score.hpp"

namespace heartservo::tools {

namespace {

using Row = std::vector<double>;

void put(Row& row, const Eigen::Vector3d& v) { row.insert(row.end(), {v.x(), v.y(), v.z()}); }
void put(Row& row, const std::optional<Eigen::Vector3d>& v) {
  put(row, v ? *v : Eigen::Vector3d(Eigen::Vector3d::Constant(NAN)));
}
void put(Row& row, const Eigen::Vector2d& v) { row.insert(row.end(), {v.x(), v.y()}); }

constexpr const char* LIVE_COLUMNS[] = {"frame/age_s",       "command/glass_to_command_s", "capture/device_s",
                                        "capture/dequeued_s", "capture/decoded_s",          "capture/device_sequence",
                                        "capture/flags",      "capture/missing",            "capture/skipped"};

void put_live(Row& row, const servo::LoopRecord& r) {
  row.insert(row.end(), {r.age_s, r.glass_to_command_s});
  const auto& c = r.frame.capture;
  if (!c) {  // a frame that was made up because none came
    row.insert(row.end(), std::size(LIVE_COLUMNS) - 2, NAN);
    return;
  }
  row.insert(row.end(), {c->device_s, c->dequeued_s, c->decoded_s, static_cast<double>(c->device_sequence),
                         static_cast<double>(c->flags), static_cast<double>(c->missing), static_cast<double>(c->skipped)});
}

std::vector<std::string> column_names(bool live) {
  std::vector<std::string> names{"time_s", "frame/sequence", "frame/status", "track/state", "track/quality"};
  const auto triple = [&](const std::string& group, const std::string& unit) {
    for (const char* axis : {"x", "y", "z"}) names.push_back(group + "/" + axis + "_" + unit);
  };
  for (const char* group : {"track", "truth"})
    for (const char* corner : {"corner0", "corner1", "corner2", "corner3"})
      for (const char* axis : {"u_px", "v_px"}) names.push_back(std::string(group) + "/" + corner + "/" + axis);
  for (const char* name :
       {"track/gain", "track/bias_grey", "track/noise_grey", "track/iterations", "marker/state", "marker/quality"})
    names.emplace_back(name);
  triple("measured", "m");
  triple("truth", "m");
  triple("goal/measured", "m");
  triple("goal/predicted", "m");
  triple("goal/truth", "m");
  triple("tip/estimated", "m");
  triple("tip/truth", "m");
  triple("residual", "m");
  names.emplace_back("residual/norm_m");
  names.emplace_back("residual/norm_px");
  for (const char* name : {"goal/truth/u_px", "goal/truth/v_px", "tip/truth/u_px", "tip/truth/v_px"})
    names.emplace_back(name);
  triple("command", "m_s");
  for (const char* name : {"command/acts_at_s", "loop/mode", "guard/limited", "guard/not_finite", "frame/stale",
                           "target/implausible", "force/felt_n", "force/wanted_n", "force/truth_n", "ecg/peak_s",
                           "timing/track_ms", "timing/chain_ms"})
    names.emplace_back(name);
  if (live) names.insert(names.end(), std::begin(LIVE_COLUMNS), std::end(LIVE_COLUMNS));
  return names;
}

}  // namespace

TimeTable make_loop_table(std::size_t rows, bool live) { return TimeTable(column_names(live), rows); }

void append(TimeTable& table, const servo::LoopRecord& r, const servo::TruthSample& truth) {
  const Eigen::Vector3d none = Eigen::Vector3d::Constant(NAN);
  const bool lost = r.target.state == tracking::TrackState::LOST;
  Row row{r.frame.time_s, static_cast<double>(r.frame.sequence), static_cast<double>(r.frame.status),
          static_cast<double>(r.track.state), r.track.quality};
  row.reserve(table.columns().size());
  for (const auto& c : r.track.corners)
    put(row, r.track.state == tracking::TrackState::LOST ? none.head<2>().eval() : c);
  for (std::size_t i = 0; i < 4; ++i) put(row, truth.corners_px ? (*truth.corners_px)[i] : none.head<2>().eval());
  row.insert(row.end(), {r.track.gain, r.track.bias, r.track.noise_grey, static_cast<double>(r.track.iterations),
                         static_cast<double>(r.marker_track.state), r.marker_track.quality});
  put(row, lost ? none : Eigen::Vector3d(r.target.T_camera_target.translation()));
  put(row, truth.target);
  put(row, r.goal_now);
  put(row, r.goal_then.valid ? r.goal_then.position : none);
  put(row, truth.goal);
  put(row, r.tip);
  put(row, truth.tip);
  const Eigen::Vector3d residual = truth.tip && truth.goal ? Eigen::Vector3d(*truth.tip - *truth.goal) : none;
  put(row, residual);
  row.push_back(residual.norm());
  row.push_back((truth.tip_px - truth.goal_px).norm());
  put(row, truth.goal_px);
  put(row, truth.tip_px);
  put(row, r.command.velocity);
  row.insert(row.end(), {r.command.acts_at_s, static_cast<double>(r.mode), r.guard.limited() ? 1.0 : 0.0,
                         r.guard.not_finite ? 1.0 : 0.0, r.stale ? 1.0 : 0.0, r.implausible ? 1.0 : 0.0,
                         r.encoders.force_n, r.force_wanted_n, truth.force_n.value_or(NAN), r.r_peak_s, r.track_ms,
                         r.chain_ms});
  if (table.has(LIVE_COLUMNS[0])) put_live(row, r);
  table.append(row);
}

TimeTable with_motion(const TimeTable& table) {
  auto names = table.columns();
  std::vector<std::vector<double>> columns;
  for (const auto& name : names) columns.emplace_back(table.column(name).begin(), table.column(name).end());
  for (const char* axis : {"x_m", "y_m", "z_m", "u_px", "v_px"}) {
    const auto goal = table.column(std::string("goal/truth/") + axis);
    double sum = 0, count = 0;
    for (const double v : goal)
      if (!std::isnan(v)) sum += v, ++count;
    columns.emplace_back();
    for (const double v : goal) columns.back().push_back(v - sum / count);
    names.push_back(std::string("motion/") + axis);
  }
  TimeTable result(names, table.rows());
  std::vector<double> row(columns.size());
  for (std::size_t i = 0; i < table.rows(); ++i) {
    for (std::size_t c = 0; c < columns.size(); ++c) row[c] = columns[c][i];
    result.append(row);
  }
  return result;
}

TimeTable tail(const TimeTable& table, double seconds) {
  TimeTable result(table.columns());
  if (table.rows() == 0) return result;
  const double from = table.time_s().back() - seconds;
  std::vector<std::span<const double>> columns;
  for (const auto& name : table.columns()) columns.push_back(table.column(name));
  std::vector<double> row(columns.size());
  for (std::size_t i = 0; i < table.rows(); ++i) {
    if (table.time_s()[i] < from) continue;
    for (std::size_t c = 0; c < columns.size(); ++c) row[c] = columns[c][i];
    result.append(row);
  }
  return result;
}

}  // namespace heartservo::tools
