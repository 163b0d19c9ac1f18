#include "sim/table/stages.hpp"

#include "sim/scene/scene.hpp"
#include "sim/table/table.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/landmark/registry.hpp"
#include "tracking/landmark/square_refinement.hpp"
#include "tracking/planar/registry.hpp"

namespace heartservo::sim {

namespace {

auto refiner(const tracking::Camera& camera, double edge_ratio) {
  return [camera, edge_ratio](const tracking::Frame& frame, const tracking::Quad& picked) {
    return edge_ratio > 0 ? tracking::refine_square(frame.grey, camera, picked, edge_ratio).corners : picked;
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

servo::LoopStages make_stages(const Scene& scene, const Table& table) {
  servo::LoopStages stages;
  const tracking::Camera& camera = table.camera();
  const HandPicked picked = table.picked();
  tracking::EstimatorOptions estimator = estimator_options(scene, table);
  stages.target_tracker = tracking::trackers().make(scene.engines.tracker, camera, scene.tracking);
  stages.target_estimator = tracking::estimators().make(scene.engines.estimator, estimator);
  stages.refine_target = refiner(camera, picked.target_edge_ratio);
  if (scene.loop.tip.use_marker) {
    estimator.side_m = table.marker_side_m();
    stages.marker_tracker = tracking::trackers().make(scene.engines.tracker, camera, scene.tracking);
    stages.marker_estimator = tracking::estimators().make("landmark_refined", estimator);
    stages.refine_marker = refiner(camera, picked.marker_edge_ratio);
  }
  if (auto ecg = table.ecg()) stages.ecg = std::make_unique<servo::EcgMonitor>(std::move(ecg));
  stages.predictor = servo::predictors().make(scene.engines.predictor, scene.loop.prediction);
  stages.control_law = servo::control_laws().make(scene.engines.controller, scene.loop.control);
  return stages;
}

servo::LoopOptions loop_options(const Scene& scene, Table& table) {
  servo::LoopOptions options = scene.loop;
  options.frame_rate_hz = table.frames().frame_rate_hz();
  options.offset_m = table.offset();
  return options;
}

}  // namespace heartservo::sim
