#include "sim/experiment/depth_rail.hpp"

#include <fmt/format.h>

#include <random>

#include "servo/loop/loop_record.hpp"
#include "sim/scene/scene.hpp"
#include "sim/table/table.hpp"
#include "tracking/landmark/registry.hpp"
#include "tracking/landmark/square_refinement.hpp"
#include "tracking/planar/registry.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {

namespace {

/// Errors of one estimator, m.
struct Errors {
  std::vector<double> laser, x, y, z;
  std::size_t frames = 0, lost = 0;

  void add(const tracking::TargetState& state, const Eigen::Vector3d& truth, double laser_z) {
    ++frames;
    if (state.state == tracking::TrackState::LOST) {
      ++lost;
      return;
    }
    const Eigen::Vector3d p = state.T_camera_target.translation(), e = p - truth;
    laser.push_back(p.z() - laser_z);
    x.push_back(e.x()), y.push_back(e.y()), z.push_back(e.z());
  }

  void add(const Errors& other) {
    const auto append = [](std::vector<double>& to, const std::vector<double>& more) {
      to.insert(to.end(), more.begin(), more.end());
    };
    append(laser, other.laser), append(x, other.x), append(y, other.y), append(z, other.z);
    frames += other.frames, lost += other.lost;
  }

  DepthRailRow row(const std::string& estimator) const {
    DepthRailRow row;
    row.estimator = estimator;
    row.frames = frames, row.lost = lost;
    row.against_laser = servo::spread_of(laser);
    row.x = servo::spread_of(x), row.y = servo::spread_of(y), row.z = servo::spread_of(z);
    return row;
  }
};

Scene tilted(Scene scene, double tilt_rad) {
  const double axis = scene.depth_rail.axis_rad;
  scene.motion.rail.turn_rad = tilt_rad * Eigen::Vector3d(std::cos(axis), std::sin(axis), 0);
  scene.show_tool = false;
  return scene;
}

std::vector<std::unique_ptr<tracking::TargetEstimator>> estimators_for(const Scene& scene, const Table& table) {
  tracking::EstimatorOptions options;
  options.camera = table.camera();
  options.side_m = table.region_side_m();
  options.corner_sigma_px = scene.tracking.corner_sigma_px;
  options.plate = table.picked().target_plate;
  std::vector<std::unique_ptr<tracking::TargetEstimator>> result;
  for (const auto& name : depth_rail_estimators()) result.push_back(tracking::estimators().make(name, options));
  return result;
}

/// One run along the rail. `go_on`: after every frame.
std::vector<Errors> run_once(const Scene& scene, std::mt19937_64& laser, const std::function<bool()>& go_on) {
  const auto table = make_table(scene);
  const auto picked = table->picked();
  const auto tracker = tracking::trackers().make(scene.engines.tracker, table->camera(), scene.tracking);
  const auto estimators = estimators_for(scene, *table);
  std::vector<Errors> errors(estimators.size());
  std::uniform_real_distribution<double> off(-scene.depth_rail.laser_m, scene.depth_rail.laser_m);
  servo::LoopRecord record;
  bool first = true;
  while (table->frames().next(record.frame)) {
    if (first) {
      const auto corners = tracking::refine_square(record.frame.grey, table->camera(), picked.target,
                                                   picked.target_edge_ratio).corners;
      if (const std::string why = tracker->start(record.frame, corners); !why.empty())
        throw ConfigError(fmt::format("{}: the landmark cannot be tracked: {}", scene.title, why));
      first = false;
    }
    record.track = tracker->track(record.frame);
    const Eigen::Vector3d truth = *table->truth(record).target;
    const double laser_z = truth.z() + off(laser);
    for (std::size_t i = 0; i < estimators.size(); ++i) {
      estimators[i]->look_at(record.frame);
      errors[i].add(estimators[i]->estimate(record.track), truth, laser_z);
    }
    if (!go_on()) break;
  }
  return errors;
}

}  // namespace

const std::vector<std::string>& depth_rail_estimators() {
  static const std::vector<std::string> names{"landmark_linear", "landmark_refined", "landmark_dense"};
  return names;
}

std::vector<DepthRailRow> run_depth_rail(const Scene& scene, const std::function<bool(std::size_t)>& go_on) {
  const auto& names = depth_rail_estimators();
  std::mt19937_64 laser(static_cast<std::uint64_t>(scene.seed) * 1000003ULL + 17);
  std::vector<DepthRailRow> rows;
  std::vector<Errors> all(names.size());
  std::size_t done = 0;
  bool on = true;
  for (const double tilt : scene.depth_rail.tilts_rad) {
    if (!on) break;
    const auto errors = run_once(tilted(scene, tilt), laser, [&] { return on = go_on(++done); });
    for (std::size_t i = 0; i < names.size(); ++i) {
      rows.push_back(errors[i].row(names[i]));
      rows.back().tilt_rad = tilt;
      all[i].add(errors[i]);
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    rows.push_back(all[i].row(names[i]));
    rows.back().all_tilts = true;
  }
  return rows;
}

}  // namespace heartservo::sim
