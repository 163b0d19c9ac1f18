#include "sim/table/stages.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "sim/scene/scene.hpp"
#include "sim/table/table.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/frames/live_source.hpp"
#include "tracking/landmark/print_refinement.hpp"
#include "tracking/landmark/registry.hpp"
#include "tracking/landmark/square_refinement.hpp"
#include "tracking/planar/registry.hpp"
#include "tracking/settings/csv_rows.hpp"

namespace heartservo::sim {

namespace {

auto refiner(const tracking::Camera& camera, double edge_ratio, const cv::Mat& plate, double side_m) {
  return [camera, edge_ratio, plate, side_m](const tracking::Frame& frame, const tracking::Quad& picked) {
    if (!(edge_ratio > 0)) return picked;
    const tracking::Quad corners = tracking::refine_square(frame.grey, camera, picked, edge_ratio).corners;
    return tracking::refine_by_print(frame.grey, camera, corners, plate, side_m);
  };
}

}  // namespace

tracking::EstimatorOptions estimator_options(const Scene& scene, const Table& table, std::size_t region) {
  tracking::EstimatorOptions estimator;
  estimator.camera = table.camera();
  estimator.side_m = table.region_side_m(region);
  estimator.depth_m = scene.recording.depth_m;
  estimator.corner_sigma_px = scene.tracking.corner_sigma_px;
  estimator.scale = table.picked(region).scale;
  estimator.depth = scene.depth.assumed;
  estimator.stereo = table.stereo();
  estimator.matching = scene.stereo.matching;
  estimator.plate = table.picked(region).target_plate;
  return estimator;
}

servo::ControlSetup control_setup(const Scene& scene, Table& table) {
  servo::ControlSetup setup;
  setup.options = scene.loop.control;
  setup.robot = table.robot().data();
  setup.period_s = 1 / table.frames().frame_rate_hz();
  setup.max_speed = std::min(scene.loop.guard.max_speed, scene.loop.guard.max_step_m / setup.period_s);
  setup.max_acceleration = scene.loop.guard.max_acceleration;
  return setup;
}

servo::LoopStages make_stages(const Scene& scene, Table& table) {
  servo::LoopStages stages;
  const tracking::Camera& camera = table.camera();
  const HandPicked picked = table.picked();
  tracking::EstimatorOptions estimator = estimator_options(scene, table);
  stages.target_tracker = tracking::trackers().make(scene.engines.tracker, camera, scene.tracking);
  stages.target_estimator = tracking::estimators().make(scene.engines.estimator, estimator);
  stages.refine_target = refiner(camera, picked.target_edge_ratio, picked.target_plate, table.region_side_m());
  if (scene.loop.tip.use_marker) {
    estimator.side_m = table.marker_side_m();
    // a rigid plate needs no more, and trackers of the heart are compared with the same tip
    stages.marker_tracker = tracking::trackers().make("esm", camera, scene.tracking);
    stages.marker_estimator = tracking::estimators().make("landmark_refined", estimator);
    stages.refine_marker = refiner(camera, picked.marker_edge_ratio, picked.marker_plate, table.marker_side_m());
  }
  if (tracking::LiveSource* live = table.frames().live()) stages.frame_clock = [live] { return live->now_s(); };
  if (auto ecg = table.ecg()) stages.ecg = std::make_unique<servo::EcgMonitor>(std::move(ecg));
  stages.predictor = servo::predictors().make(scene.engines.predictor, scene.loop.prediction);
  stages.control_law = servo::control_laws().make(scene.engines.controller, control_setup(scene, table));
  return stages;
}

std::vector<servo::PathPoint> read_path(const std::string& file) {
  CsvRows rows(file, "time_s, x_m, y_m, z_m");
  std::size_t columns[4];
  for (std::size_t i = 0; i < 4; ++i) {
    const char* name = std::array{"time_s", "x_m", "y_m", "z_m"}[i];
    const auto found = rows.find(name);
    if (!found) rows.fail(fmt::format("has no column {}; expected time_s, x_m, y_m, z_m", name));
    columns[i] = *found;
  }
  std::vector<servo::PathPoint> points;
  while (rows.next()) {
    const servo::PathPoint point{rows.number(columns[0]),
                                 {rows.number(columns[1]), rows.number(columns[2]), rows.number(columns[3])}};
    if (!std::isfinite(point.time_s) || !point.position.allFinite()) rows.fail("an empty cell");
    if (!points.empty() && !(point.time_s > points.back().time_s)) rows.fail("time_s does not increase");
    points.push_back(point);
  }
  if (points.size() < 2) rows.fail("a path needs two points or more");
  return points;
}

servo::SurgeonPath surgeon_path(const Scene& scene) {
  const auto& path = scene.loop.path;
  return servo::SurgeonPath(path, path.type == "file" ? read_path(resolve(scene, path.file))
                                                      : std::vector<servo::PathPoint>{});
}

servo::LoopOptions loop_options(const Scene& scene, Table& table) {
  servo::LoopOptions options = scene.loop;
  options.frame_rate_hz = table.frames().frame_rate_hz();
  options.offset_m = table.offset();
  options.tool_axis = table.tool_axis();
  if (options.path.type == "file") options.recorded_path = read_path(resolve(scene, options.path.file));
  return options;
}

}  // namespace heartservo::sim
